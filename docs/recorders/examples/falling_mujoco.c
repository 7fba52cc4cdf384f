// Three lines of obscura's in a program with MuJoCo: a leaning crate, a ball and a capsule fall onto a slope.
#include "obscura_mujoco.h"

static const char* kModel =
    "<mujoco><option timestep='0.002'/><worldbody>"
    "<geom type='plane' size='0 0 1'/>"
    "<geom name='slope' type='box' size='0.8 0.5 0.03' pos='0 0 0.3' euler='0 15 0'/>"
    "<body name='crate' pos='-0.3 0.1 1.2' euler='20 10 0'><freejoint/><geom type='box' size='0.15 0.1 0.08'/></body>"
    "<body name='ball' pos='0.3 -0.2 0.9'><freejoint/><geom type='sphere' size='0.12'/></body>"
    "<body name='rod' pos='0.1 0.2 0.8' euler='70 0 0'><freejoint/><geom type='capsule' size='0.06 0.15'/></body>"
    "<body name='drum' pos='-0.1 -0.2 1.4' euler='0 60 0'><freejoint/><geom type='cylinder' size='0.1 0.08'/></body>"
    "</worldbody></mujoco>";

int main(void) {
  FILE* file = fopen("falling.xml", "w");
  fputs(kModel, file), fclose(file);
  char error[400] = "";
  mjModel* m = mj_loadXML("falling.xml", NULL, error, sizeof error);
  if (!m) return fprintf(stderr, "%s\n", error), 1;
  mjData* d = mj_makeData(m);

  obscura_begin(m, d, "run", 20);
  for (int step = 0; step <= 500; ++step) {
    obscura_frame();
    mj_step(m, d);
  }
  return 0;
}
