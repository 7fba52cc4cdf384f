#version 330 core

flat in vec2 shift;                    // pixel to texel
flat in vec4 ink;
uniform sampler2D atlas;
out vec4 color;

void main() { color = ink * texelFetch(atlas, ivec2(gl_FragCoord.xy + shift), 0).r; }
