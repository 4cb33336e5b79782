/* Steps a scene to its end in C, with no other library, and prints its state hash; then the same with a weight added to each body. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "scree_engine.h"

static int complain(const char* what) {
  fprintf(stderr, "%s: %s\n", what, scree_error());
  return 3;
}

/* Pulls every body up with half of its weight. */
static int lift(void* user, scree_engine* engine, int64_t count, double* force, double* torque) {
  const double* mass = scree_reals(engine, "mass");
  (void)torque;
  ++*(int64_t*)user;
  for (int64_t i = 0; i < count; ++i) force[3 * i + 2] = -0.5 * scree_gravity(engine, 2) * mass[i];
  return 0;
}

int main(int argc, char** argv) {
  scree_engine* engine = NULL;
  scree_state* start = NULL;
  scree_energies energies;
  char hash[33];
  int64_t calls = 0;
  int number = 0;
  if (argc != 2 || scree_engine_abi() != SCREE_ENGINE_ABI) return 2;
  if (scree_open("no such file", NULL, NULL, NULL, 0, &engine) != SCREE_BAD_DATA || engine != NULL) return 1;
  if (scree_open(argv[1], NULL, NULL, NULL, 0, &engine) != SCREE_DONE) return complain("open");
  if (scree_save(engine, &start) != SCREE_DONE) return complain("save");
  if (scree_run_until(engine, scree_duration(engine)) != SCREE_DONE) return complain("run_until");
  if (scree_state_hash(engine, hash) != SCREE_DONE) return complain("state_hash");
  printf("%s %lld steps\n", hash, (long long)scree_step_count(engine));
  if (scree_restore(engine, start) != SCREE_DONE) return complain("restore");
  if (scree_add_force(engine, lift, 1, &calls, &number) != SCREE_DONE) return complain("add_force");
  const int64_t steps = 100;
  const double z = scree_reals(engine, "position")[2];
  if (scree_step(engine, steps) != SCREE_DONE) return complain("step");
  if (scree_get_energies(engine, &energies) != SCREE_DONE) return complain("energies");
  /* in free fall with half of the weight: z = z0 + g/2 t^2 / 2 exactly, by leapfrog too */
  const double t = scree_time(engine), fallen = z + 0.25 * scree_gravity(engine, 2) * t * t;
  printf("%lld calls, %s, %s\n", (long long)calls, fabs(scree_reals(engine, "position")[2] - fallen) < 1e-12 ? "as it should fall" : "falls otherwise",
         energies.outer_work < 0 ? "held back" : "not held back");
  scree_free_state(start);
  return scree_close(engine) == SCREE_DONE ? 0 : complain("close");
}
