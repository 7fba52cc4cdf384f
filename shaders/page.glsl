// Pixels to clip space. The page's y runs down and a framebuffer's up, so that its first row is the picture's top:
// gl_FragCoord.xy is then a pixel's centre on the page.
uniform vec2 per_half_size;            // 2 / (width, height)

vec4 on_page(vec2 at) { return vec4(at * per_half_size - 1.0, 0.0, 1.0); }

vec4 premultiplied(vec4 color) { return vec4(color.rgb * color.a, color.a); }
