#version 330 core

// The ground's shadow over the picture.

uniform sampler2D dark;
uniform vec4 shade;                    // premultiplied
uniform vec2 per_size;                 // 1 / px of the picture
out vec4 color;

void main() { color = shade * texture(dark, gl_FragCoord.xy * per_size).r; }
