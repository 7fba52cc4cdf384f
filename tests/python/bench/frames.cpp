// frames SCENE WIDTH HEIGHT COUNT: the CPU seconds that the frames of a film take, one by one, by the
// library.

#include <obscura/obscura.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  const int count = std::atoi(argv[4]);
  obscura::Renderer renderer(obscura::Scene::read(argv[1]),
                             {.width = std::atoi(argv[2]), .height = std::atoi(argv[3])});
  renderer.at(0);  // the context, the fonts
  unsigned sum = 0;
  const std::clock_t begun = std::clock();
  for (int n = 0; n < count; ++n) sum += renderer.next()->pixels[0];
  std::printf("%.6f\n", double(std::clock() - begun) / CLOCKS_PER_SEC);
  return sum == 0;
}
