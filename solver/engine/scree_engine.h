/* The engine of Scree as a plain C library: a program of yours opens a scene, steps it, reads its bodies and acts on them.
 *
 *   scree_engine* e = NULL;
 *   if (scree_open("bed.scene.h5", NULL, NULL, NULL, 0, &e) != SCREE_DONE) return complain(scree_error());
 *   while (scree_time(e) < 0.2 && scree_step(e, 100) == SCREE_DONE) look(scree_body_count(e), scree_reals(e, "position"));
 *   scree_close(e);
 *
 * Units: SI. Frame: that of the world, right-handed; vectors are x y z, quaternions w x y z. Arrays lie row after row.
 *
 * Ranks. All functions are collective: every rank of the communicator calls them in the same order with the same arguments, except for those
 * of the sections "Bodies of this rank" and "Facts", and for lists of ids, of which each rank may give its own part. A rank holds the bodies
 * that it owns: others after each step, in any order. One thread of a process calls an engine at a time; several engines may be open.
 *
 * Errors. A function that can fail returns SCREE_DONE or a code of the list below, the same on every rank, and scree_error() says what was
 * wrong and what to do. SCREE_USAGE changes nothing, but for a function of forces that fails within a step. After any other error within a step, and after that
 * one, bodies are in the midst of a step: reading them, energies and walls is a SCREE_USAGE. What is left is scree_restore(), scree_remove_force(), scree_close(),
 * and scree_write_frame() to find the cause. scree_step_count() and scree_time() are those of the step that failed.
 *
 * Numbers. A run without any input gives the same bits as scree-solver, on any number of ranks and threads. The library sets its number of threads,
 * the rounding of floating-point numbers and the treatment of denormal numbers in each call, and puts back those of the caller.
 *
 * Waiting threads. With more than one thread a rank, set GOMP_SPINCOUNT=2000 or OMP_WAIT_POLICY=passive before the process starts, as scree-solver and the Python
 * package do: else threads that wait for the caller between two calls hold their cores, and a step can take a hundred times as long.
 *
 * Page: docs/user/engine.md. The interface has a version, SCREE_ENGINE_ABI: functions are added, and none is changed, within one.
 */
#ifndef SCREE_ENGINE_H
#define SCREE_ENGINE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SCREE_API __attribute__((visibility("default")))

#define SCREE_ENGINE_ABI 1
/* Of the library that is loaded. */
SCREE_API int scree_engine_abi(void);
SCREE_API const char* scree_engine_version(void);

typedef struct scree_engine scree_engine;
typedef struct scree_state scree_state;

/* The exit codes of the tools. Of an interrupted step: 128 and the number of the signal. */
enum {
  SCREE_DONE = 0,
  SCREE_INTERNAL = 1,   /* our mistake */
  SCREE_USAGE = 2,      /* a mistake in a call, or in the case */
  SCREE_BAD_DATA = 3,   /* a file that cannot be used */
  SCREE_SYSTEM = 4,     /* disk, memory, MPI */
  SCREE_RUN_INVALID = 5 /* the simulation became invalid */
};
/* Text of the last call of this thread that failed; "" without one. Valid until the next failure. */
SCREE_API const char* scree_error(void);
/* Warnings go to a function in place of stderr: those of all engines of this process. NULL: to stderr. */
SCREE_API void scree_on_warning(void (*function)(void* user, const char* text), void* user);

/* ---- Begin and end ---- */

/* Opens a scene and computes its first forces.
 * in   comm     address of an MPI_Comm, of which the engine makes a duplicate; NULL: this process alone. MPI is begun where it is not, and then ended
 *               at the exit of the process.
 * in   run      a run folder to make, with all files that scree-solver would write; NULL: none is written
 * in   restart  path of a checkpoint; "latest" or "auto" of the run folder; NULL: from the scene
 * in   threads  number of OpenMP threads of a rank; 0: OMP_NUM_THREADS where that is set, else as many as the bodies keep busy
 * out  engine   NULL after a failure
 */
SCREE_API int scree_open(const char* scene, const void* comm, const char* run, const char* restart, int threads, scree_engine** engine);
/* The same for Fortran, whose communicators are integers. */
SCREE_API int scree_open_fortran(const char* scene, int comm, const char* run, const char* restart, int threads, scree_engine** engine);
/* Ends the run, and writes the last files of one with a folder. NULL is allowed. */
SCREE_API int scree_close(scree_engine* engine);

/* ---- Steps ---- */

/* Makes n steps. With a run folder, a run that is over is a SCREE_USAGE. */
SCREE_API int scree_step(scree_engine* engine, int64_t n);
/* Steps until the first moment at or after a time [s]. */
SCREE_API int scree_run_until(scree_engine* engine, double time);
/* `function` is called on this rank about every `interval` seconds of wall time while steps are made. A result other than 0, a number of
 * a signal, stops all ranks after the same step: scree_step() returns 128 and this number. The engine itself catches no signal. NULL: none. */
SCREE_API int scree_on_poll(scree_engine* engine, int (*function)(void* user), double interval, void* user);

/* ---- Facts: of the whole scene, known on every rank ---- */

SCREE_API double scree_time(const scree_engine* engine);        /* [s] */
SCREE_API double scree_dt(const scree_engine* engine);          /* length of a step [s] */
SCREE_API int64_t scree_step_count(const scree_engine* engine); /* steps since the start of the run */
SCREE_API double scree_duration(const scree_engine* engine);    /* of the case [s] */
SCREE_API int scree_is_over(const scree_engine* engine);        /* whether the duration of the case has passed, or a run with a folder has ended */
SCREE_API double scree_gravity(const scree_engine* engine, int component);
SCREE_API int scree_shape_count(const scree_engine* engine);
SCREE_API const char* scree_shape_name(const scree_engine* engine, int shape); /* NULL: there is none */
SCREE_API int scree_material_count(const scree_engine* engine);
SCREE_API const char* scree_material_name(const scree_engine* engine, int material);

/* ---- Bodies of this rank ---- */

SCREE_API int64_t scree_body_count(const scree_engine* engine);
/* A field of the bodies that this rank owns, row by row. Valid until the next call that changes the engine; within a function of forces until it
 * returns. NULL: no such field, or no memory, see scree_error(). In a scene without bodies on this rank: not NULL, of no length.
 *   1 number a body   mass [kg], volume [m^3], diameter (of the ball of equal volume) [m], radius (bounding) [m], scale, temperature [K]
 *   3                 position (centre of mass) [m], velocity [m/s], angular_velocity [rad/s], force [N], torque [N m] about the centre
 *   4                 quaternion: axes of the shape's mesh to the world
 * force and torque are those of the last step with what acts from outside.
 * Cost: none for what lies as it is read (velocity, mass); else a copy: 200 000 positions in 0.3 ms.
 */
SCREE_API const double* scree_reals(scree_engine* engine, const char* field);
/* The same of whole numbers: id, shape, material, fixed (1: never moves), asleep (1). */
SCREE_API const int64_t* scree_integers(scree_engine* engine, const char* field);

/* ---- Forces from outside ---- */

/* Forces [N], and torques [N m] about the centres of mass, held on n bodies until they are given again; each in place of what was held on its
 * body before. They act at once, from the first half kick of the next step on: for partners that change slowly (a fluid, a
 * controller). For a force that follows from places or velocities use scree_add_force(): a spring that is held for a step gains energy.
 * Any rank may name any body. torques: NULL: none.
 * SCREE_USAGE: an id that is unknown, given twice, or of a fixed body; a number that is not finite. Nothing is changed then.
 */
SCREE_API int scree_set_wrench(scree_engine* engine, int64_t n, const int64_t* ids, const double* forces, const double* torques);
/* Holds nothing any more: on n bodies, of which each rank may name its own; n = -1: on all, and then on every rank. */
SCREE_API int scree_clear_wrench(scree_engine* engine, int64_t n, const int64_t* ids);
/* `function` is called on every rank in every step when bodies are at their new places, with the velocities of half a step before, as damping is
 * evaluated: a drag C is of first order in the step, and stable for dt < 2 m / C. The call of scree_add_force() itself calls it as well, for the first half
 * kick: n steps take n + 1 calls. Not so after a restart: up to the next step, functions take the forces that those of the checkpoint had, in the order in
 * which they are added; the same functions in the same order go on with the same bits. It adds to force and torque, 3 numbers for each body of this rank, all 0 before. It may read by
 * scree_reals(), scree_integers() and the facts, and call nothing else. A result other than 0 ends the step on all ranks with SCREE_USAGE.
 * every: in steps whose number is a multiple of it; between them the last forces are held. Functions are called in the order in which
 * they were added. out: its number, for scree_remove_force(). */
typedef int (*scree_force_function)(void* user, scree_engine* engine, int64_t count, double* force, double* torque);
SCREE_API int scree_add_force(scree_engine* engine, scree_force_function function, int64_t every, void* user, int* number);
/* The same with a name for messages and run.json. */
SCREE_API int scree_add_named_force(scree_engine* engine, const char* name, scree_force_function function, int64_t every, void* user, int* number);
/* Within a function of forces that is about to return another number than 0: why, for the error that scree_step() returns and for run.json. */
SCREE_API void scree_force_failed(scree_engine* engine, const char* text);
SCREE_API int scree_remove_force(scree_engine* engine, int number);

/* ---- Heat from outside: only in scenes with a table [heat], else SCREE_USAGE ---- */

/* Sources of heat: powers [W] into n bodies, held until they are given again; each in place of what its body had before. A power below 0 cools;
 * 0 ends the source. They add to the key heat_source of the case, and act from the next step on, over the whole of it.
 * ids: NULL: the bodies of this rank in the order of scree_reals(), n = scree_body_count(). Any rank may name any body, fixed and sleeping ones
 * too; none wakes.
 * SCREE_USAGE: an id that is unknown or given twice; a number that is not finite. Nothing is changed then.
 * Cost: O(n log n), 16 B for each id to every rank. */
SCREE_API int scree_set_heat_source(scree_engine* engine, int64_t n, const int64_t* ids, const double* powers);
/* Media: what surrounds n bodies, a fluid that the program computes. A body of temperature T gets the power G (T_m - T), with its conductance
 * G = h A [W/K] and the temperature T_m [K] of the medium, both held until they are given again. T is that of each stage of a step: the exchange
 * is of second order (Heun). G counts in the critical step of heat, the mass times heat capacity over the conductances of a body: a longer step of
 * the run ends scree_step() with SCREE_RUN_INVALID. G = 0: nothing passes. ids as in scree_set_heat_source().
 * SCREE_USAGE: the same; G < 0 or T_m <= 0. */
SCREE_API int scree_set_medium(scree_engine* engine, int64_t n, const int64_t* ids, const double* conductances, const double* temperatures);
/* Ends sources and media of n bodies, of which each rank may name its own; n = -1: of all, and then on every rank. */
SCREE_API int scree_clear_heat(scree_engine* engine, int64_t n, const int64_t* ids);
/* out: heat [J] that has passed from its medium to each of n bodies since it was last taken, to rounding what the body was heated by: the medium has
 * lost as much. 0 of a body without a medium. A body that had a medium and has left the run may be named once after that. Each rank names its own
 * part. ids as in scree_set_heat_source(). scree_save(), scree_restore() and checkpoints keep what has not been taken.
 * SCREE_USAGE: an id that is unknown or given twice. Nothing is taken then. Cost: O(n log n), 16 B for each id to every rank. */
SCREE_API int scree_take_medium_heat(scree_engine* engine, int64_t n, const int64_t* ids, double* heat);
/* Heat of the whole scene [J], as in log.csv: stored (mass times heat capacity times temperature of all bodies); since the start made by contacts in
 * bodies and in walls, given by sources of the case, by those of scree_set_heat_source(), by media and by walls, arrived with bodies that came in,
 * removed with those that left. balance: stored + removed - made - from_sources - from_program - from_medium - from_walls - arrived: it stays the
 * same but for rounding. critical_step [s] (the step must not exceed it) and the largest Biot number are of contacts and media in the last step. */
typedef struct {
  double stored, made, made_in_walls, from_sources, from_program, from_medium, from_walls, arrived, removed, balance, critical_step, biot;
} scree_heat;
SCREE_API int scree_get_heat(scree_engine* engine, scree_heat* heat);

/* ---- Walls ---- */

SCREE_API int scree_wall_count(const scree_engine* engine);
SCREE_API const char* scree_wall_name(const scree_engine* engine, int wall);
/* Force [N] and torque [N m] about the world's origin, of all bodies on each wall: 6 numbers a wall. */
SCREE_API int scree_wall_loads(scree_engine* engine, double* loads);
/* Position [m], quaternion, velocity [m/s] of its origin, angular velocity [rad/s]: 13 numbers. Not collective. */
SCREE_API int scree_wall_state(scree_engine* engine, int wall, double* state);
/* Moves a wall with the motion `outer` of the case from now on at a rate [m/s] along its direction, or [rad/s] about its axis, until it is given
 * again; the same on every rank. SCREE_USAGE: another wall, or a rate above its max_speed or max_rate. */
SCREE_API int scree_drive_wall(scree_engine* engine, int wall, double rate);
/* How far a wall with the motion outer, servo, free or motor has gone from where it was placed [m] or [rad], and its rate. Not collective. */
SCREE_API int scree_wall_way(scree_engine* engine, int wall, double* way, double* rate);

/* ---- Measures of the whole scene ---- */

/* [J]; balance: translational + rotational + potential + elastic + tangential_elastic + dissipated + bond + fracture + slept + removed - arrived - wall_work
 * - outer_work. It stays the same but for the error of the run: the error since a moment is the difference to the balance of that moment. dissipated, wall_work, outer_work,
 * removed (by bodies that left), arrived (with bodies that came in), fracture (of bonds as they broke) and slept (of bodies as they fell asleep) are since the start. */
typedef struct {
  double translational, rotational, potential, elastic, tangential_elastic, dissipated, wall_work, outer_work, removed, arrived, bond,
      fracture, slept, balance;
} scree_energies;
SCREE_API int scree_get_energies(scree_engine* engine, scree_energies* energies);
/* Hash of the whole state: 32 digits and a 0. */
SCREE_API int scree_state_hash(scree_engine* engine, char* text33);
/* Largest stable step of the contacts that there are [s]. */
SCREE_API int scree_critical_step(scree_engine* engine, double* step);
/* Contacts counted by this rank: collects them, and gives their number. Then scree_contact_reals(): overlap, margin [m], normal_force [N] of 1
 * number, point [m], normal (from b to a), tangential_force [N] (both on a) of 3; scree_contact_integers(): body_a, body_b, feature. Valid until the next call
 * of scree_contacts(). */
SCREE_API int scree_contacts(scree_engine* engine, int64_t* count);
SCREE_API const double* scree_contact_reals(const scree_engine* engine, const char* field);
SCREE_API const int64_t* scree_contact_integers(const scree_engine* engine, const char* field);

/* ---- States ---- */

/* Keeps the present state in memory, held forces included; scree_restore() goes back to it, as often as wanted, with the same bits after it. Functions stay as
 * they are at that time; one that was removed since the state was kept still acts in the first half kick after it. Until the next step, loads of walls and energies are those
 * of contacts without their damping; the same after a restart. SCREE_USAGE while bodies wait to join or to leave. In a run with a folder scree_restore() is a SCREE_USAGE: its files would tell another story. */
SCREE_API int scree_save(scree_engine* engine, scree_state** state);
SCREE_API int scree_restore(scree_engine* engine, const scree_state* state);
SCREE_API void scree_free_state(scree_state* state);
/* Writes a checkpoint into a folder that exists, named by its step; no more than the last two in a folder are kept. */
SCREE_API int scree_write_checkpoint(scree_engine* engine, const char* folder);
/* Writes a frame, as those of a run, to a path. */
SCREE_API int scree_write_frame(scree_engine* engine, const char* path);

/* ---- Bodies that come and go ---- */

typedef struct {
  const char *shape, *material; /* by name */
  double position[3], quaternion[4], velocity[3], angular_velocity[3], scale;
} scree_new_body;
/* n bodies join in the next step, whose end they reach as they are given here if they touch nothing. out: n ids. Each rank gives its own; ids are
 * given in the order of ranks. SCREE_USAGE, and no body joins: a shape or material that is unknown, a number that is not finite, a place outside a bounded domain,
 * a body within another one or behind a wall, a size for which the margins or ranges of attraction of the scene were not made, or whose contacts need a
 * shorter step than that of the run. A warning reports an overlap of more than 2 % of a radius, and again one that is at least twice as large. Until they have joined,
 * scree_set_wrench(), the functions of heat and scree_remove() refuse them. */
SCREE_API int scree_insert(scree_engine* engine, int64_t n, const scree_new_body* bodies, int64_t* ids);
/* The same with a temperature [K] of each body, for scenes with heat. scree_insert(), and temperatures = NULL, take heat.temperature of the case.
 * SCREE_USAGE as well: a temperature <= 0 or not finite; none here and none in the case; a material without heat_capacity and conductivity; a scene
 * without heat. */
SCREE_API int scree_insert_with_temperature(scree_engine* engine, int64_t n, const scree_new_body* bodies, const double* temperatures, int64_t* ids);
/* Takes bodies out in the next step, booked as those that leave the domain. */
SCREE_API int scree_remove(scree_engine* engine, int64_t n, const int64_t* ids);

#ifdef __cplusplus
}
#endif

#endif
