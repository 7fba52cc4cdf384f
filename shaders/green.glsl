// The area of a polygon within a pixel, exactly: for each edge from p to q the area of the pixel to its right,
// signed by the way it runs along y, summed (Green's theorem).

// the mean of clamp(f, 0, 1) where f runs evenly from f0 to f1
float mean_clamped(float f0, float f1) {
  float c0 = clamp(f0, 0.0, 1.0), c1 = clamp(f1, 0.0, 1.0);
  float step = f1 - f0;
  float whole = (0.5 * (c1 * c1 - c0 * c0) + max(f1 - 1.0, 0.0) - max(f0 - 1.0, 0.0)) / step;
  return c0 == c1 ? c0 : abs(step) < 0.02 ? 0.5 * (c0 + c1) : whole;
}

// what the edge from p to q, seen from the pixel's low corner, adds
float beside(vec4 line) {
  float y0 = clamp(line.y, 0.0, 1.0), y1 = clamp(line.w, 0.0, 1.0);
  float rise = line.w - line.y;
  float slope = (line.z - line.x) / (rise == 0.0 ? 1.0 : rise);
  float x0 = line.x + (y0 - line.y) * slope;
  float x1 = line.x + (y1 - line.y) * slope;
  return (y1 - y0) * mean_clamped(1.0 - x0, 1.0 - x1);
}
