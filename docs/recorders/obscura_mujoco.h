// Records a simulation by MuJoCo for obscura: a table of its states, and a scene that shows them.
//
//     #include "obscura_mujoco.h"                 in one file of a program
//     obscura_begin(m, d, "run", 10);             writes run.csv, and run.toml where there is none
//     obscura_frame();                            before each mj_step: every tenth is a row
//
// Each geom is a body of the scene. MuJoCo's z is up, obscura's is y: (x, y, z) becomes (x, z, -y), in geoms' own frames too.
#pragma once
#include <ctype.h>
#include <math.h>
#include <mujoco/mujoco.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
static struct {
  const mjModel* m;
  mjData* d;
  const char* name;  // without folders
  int every, steps;
  double last;  // s: the time of the last row
  FILE *table, *scene;
  double low[3], high[3];  // where moving geoms have been, in obscura's axes
} obscura_;

static const double kPi = 3.14159265358979323846;

static int obscura_moves(int geom) {
  int body = obscura_.m->geom_bodyid[geom];
  return obscura_.m->body_weldid[body] != 0 || obscura_.m->body_mocapid[body] >= 0;
}

// geoms of groups 3 to 5 are hidden in MuJoCo's viewer too
static int obscura_shown(int geom) {
  int type = obscura_.m->geom_type[geom];
  return type != mjGEOM_PLANE && type != mjGEOM_HFIELD && obscura_.m->geom_group[geom] < 3;
}

static void obscura_name(int geom, char name[64]) {
  const mjModel* m = obscura_.m;
  int body = m->geom_bodyid[geom];
  const char *own = mj_id2name(m, mjOBJ_GEOM, geom), *of = mj_id2name(m, mjOBJ_BODY, body);
  if (own || (of && m->body_geomnum[body] == 1)) snprintf(name, 64, "%s", own ? own : of);
  else snprintf(name, 64, "%.50s_%d", of ? of : "geom", geom);
  for (char* c = name; *c; ++c) *c = isalnum((unsigned char)*c) ? *c : '_';
  if (!isalpha((unsigned char)name[0])) name[0] = '_';
}

// the box around a mesh's vertices stands for it: its half sides and its middle, in the geom's frame
static void obscura_mesh(int geom, double half[3], double middle[3]) {
  const mjModel* m = obscura_.m;
  int mesh = m->geom_dataid[geom];
  for (int k = 0; k < 3; ++k) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (int i = 0; i < m->mesh_vertnum[mesh]; ++i) {
      low = fmin(low, m->mesh_vert[3 * (m->mesh_vertadr[mesh] + i) + k]);
      high = fmax(high, m->mesh_vert[3 * (m->mesh_vertadr[mesh] + i) + k]);
    }
    half[k] = (high - low) / 2, middle[k] = (high + low) / 2;
  }
}

// where a geom is, in obscura's axes: its middle, its orientation x y z w, its velocity and spin
static void obscura_pose(int geom, double p[3], double q[4], double v[6]) {
  double half[3], c[3] = {0, 0, 0}, at[3], own[4], w[6], *u = w + 3;  // u: of its origin
  if (obscura_.m->geom_type[geom] == mjGEOM_MESH) obscura_mesh(geom, half, c);
  mju_rotVecMat(at, c, obscura_.d->geom_xmat + 9 * geom);
  mju_mat2Quat(own, obscura_.d->geom_xmat + 9 * geom);
  mj_objectVelocity(obscura_.m, obscura_.d, mjOBJ_GEOM, geom, w, 0);
  const double* o = obscura_.d->geom_xpos + 3 * geom;
  p[0] = o[0] + at[0], p[1] = o[2] + at[2], p[2] = -o[1] - at[1];
  v[0] = u[0] + w[1] * at[2] - w[2] * at[1], v[1] = u[2] + w[0] * at[1] - w[1] * at[0];
  v[2] = -u[1] - w[2] * at[0] + w[0] * at[2], v[3] = w[0], v[4] = w[2], v[5] = -w[1];
  q[0] = own[1], q[1] = own[3], q[2] = -own[2], q[3] = own[0];
}

static void obscura_shape(int geom) {
  FILE* out = obscura_.scene;
  const double* s = obscura_.m->geom_size + 3 * geom;
  double half[3] = {s[0], s[1], s[2]}, middle[3];
  switch (obscura_.m->geom_type[geom]) {
    case mjGEOM_SPHERE: fprintf(out, "\n[[ball]]\nradius = %.9g\n", s[0]); break;
    case mjGEOM_CAPSULE: fprintf(out, "\n[[capsule]]\nradius = %.9g\nlength = %.9g\n", s[0], 2 * (s[0] + s[1])); break;
    case mjGEOM_MESH: obscura_mesh(geom, half, middle);  // fall through
    case mjGEOM_ELLIPSOID:
    case mjGEOM_BOX: fprintf(out, "\n[[box]]\nsize = [%.9g, %.9g, %.9g]\n", 2 * half[0], 2 * half[2], 2 * half[1]); break;
    default:  // of a cylinder, and what else there is, two rings of 24
      fprintf(out, "\n[[hull]]\npoints = [\n");
      for (int i = 0; i < 48; ++i)
        fprintf(out, "  [%.9g, %.9g, %.9g],\n", s[0] * cos(i * kPi / 12), i < 24 ? s[1] : -s[1], s[0] * sin(i * kPi / 12));
      fprintf(out, "]\n");
  }
}

static void obscura_end(void) {
  const mjModel* m = obscura_.m;
  double *low = obscura_.low, *high = obscura_.high, wide = fmax(high[0] - low[0], high[2] - low[2]), margin = 0.1 * wide;
  int ground = 0;
  for (int i = 0; i < m->ngeom; ++i)
    if (m->geom_type[i] == mjGEOM_PLANE && !obscura_moves(i)) ground = 1, low[1] = obscura_.d->geom_xpos[3 * i + 2];
  fprintf(obscura_.scene, "\n[room]\nsize = [%.9g, %.9g, %.9g]\ncorner = [%.9g, %.9g, %.9g]\nwalls = \"%s\"\n", high[0] - low[0] + 2 * margin,
          high[1] - low[1] + margin, high[2] - low[2] + 2 * margin, low[0] - margin, low[1], low[2] - margin, ground ? "ground" : "none");
  fprintf(obscura_.scene, "\n[golden]\nstates = \"%s.csv\"\nat = [0, %.6f]\n", obscura_.name, obscura_.last);
  fclose(obscura_.scene), fclose(obscura_.table);
}

static void obscura_begin(const mjModel* m, mjData* d, const char* name, int every) {
  char file[240], geom[64];
  snprintf(file, sizeof file, "%s.csv", name), obscura_.table = fopen(file, "w");
  snprintf(file, sizeof file, "%s.toml", name), obscura_.scene = fopen(file, "wx");
  if (!obscura_.scene) obscura_.scene = fopen("/dev/null", "w");  // a scene that is there is yours
  if (!obscura_.table || !obscura_.scene) perror(name), exit(1);
  obscura_.m = m, obscura_.d = d, obscura_.every = every, obscura_.name = strrchr(name, '/') ? strrchr(name, '/') + 1 : name;
  for (int k = 0; k < 3; ++k) obscura_.low[k] = HUGE_VAL, obscura_.high[k] = -HUGE_VAL;
  mj_kinematics(m, d), mj_comPos(m, d), mj_comVel(m, d);
  fprintf(obscura_.scene, "duration = 3600  # or the table's end\n[film]\nfps = %.9g\n[physics]\noverlap = \"separate\"\n",
          1 / (m->opt.timestep * every));
  fprintf(obscura_.table, "time");
  const char* columns[] = {"position.x", "position.y", "position.z", "orientation.x", "orientation.y", "orientation.z", "orientation.w",
                           "velocity.x", "velocity.y", "velocity.z", "spin.x", "spin.y", "spin.z"};
  for (int i = 0; i < m->ngeom; ++i) {
    if (!obscura_shown(i)) continue;
    double p[3], q[4], v[6];
    obscura_name(i, geom), obscura_pose(i, p, q, v), obscura_shape(i);
    double sine = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
    fprintf(obscura_.scene, "name = \"%s\"\nposition = [%.9g, %.9g, %.9g]\n", geom, p[0], p[1], p[2]);
    if (sine > 1e-9)
      fprintf(obscura_.scene, "orientation = { axis = [%.9g, %.9g, %.9g], angle = %.9g }\n", q[0], q[1], q[2], 360 / kPi * atan2(sine, q[3]));
    if (!obscura_moves(i)) fprintf(obscura_.scene, "fixed = true\ncolor = \"grey\"\n");
    for (int k = 0; obscura_moves(i) && k < 13; ++k) fprintf(obscura_.table, ",%s.%s", geom, columns[k]);
  }
  fprintf(obscura_.table, "\n"), atexit(obscura_end);
}

static void obscura_frame(void) {
  if (obscura_.steps++ % obscura_.every) return;
  mj_kinematics(obscura_.m, obscura_.d), mj_comPos(obscura_.m, obscura_.d), mj_comVel(obscura_.m, obscura_.d);
  fprintf(obscura_.table, "%.17g", obscura_.last = obscura_.d->time);
  for (int i = 0; i < obscura_.m->ngeom; ++i) {
    double p[3], q[4], v[6];
    if (!obscura_shown(i) || !obscura_moves(i)) continue;
    obscura_pose(i, p, q, v);
    fprintf(obscura_.table, ",%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g", p[0], p[1], p[2], q[0], q[1], q[2], q[3]);
    for (int k = 0; k < 6; ++k) fprintf(obscura_.table, ",%.17g", v[k]);
    for (int k = 0; k < 3; ++k) {
      obscura_.low[k] = fmin(obscura_.low[k], p[k] - obscura_.m->geom_rbound[i]);
      obscura_.high[k] = fmax(obscura_.high[k], p[k] + obscura_.m->geom_rbound[i]);
    }
  }
  fprintf(obscura_.table, "\n");
}
