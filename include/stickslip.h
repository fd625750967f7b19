/*
 * stickslip: frictional contact of a viscoelastic (Kelvin-Voigt) body as a component that a host steps and rolls back.
 *
 *     stickslip_model *model;            compile a scene once, or load a compiled one
 *     stickslip_simulator *sim;          any number of simulators of one model
 *     stickslip_init, then per step      stickslip_set_inputs, stickslip_do_step, stickslip_get_outputs
 *     rollback                           stickslip_save_state, ..., stickslip_restore_state
 *
 * Conventions
 *
 * Results     Every function that can fail returns an int32_t: STICKSLIP_OK (0), a note (> 0: done, but read
 *             stickslip_last_error), or a code (< 0: not done). The codes an error list names are those of
 *             enum stickslip_code, without the prefix; every function may also return STICKSLIP_NULL,
 *             STICKSLIP_POISONED, or STICKSLIP_VALUE for a handle of the wrong kind or a misaligned pointer.
 *             stickslip_last_error copies out one line that names what was expected and what was found.
 * On failure  nothing is written through result pointers and the state is bit for bit what it was.
 * Handles     are opaque; what _new, _compile, _load and _clone give, the caller gives back to _free, once. _free(NULL) does
 *             nothing. They may be freed in any order: a simulator keeps what it needs of its model. Using a handle
 *             after its _free is undefined, as always in C; it is refused only by luck.
 * Arrays      belong to the caller and are not kept. A length is the number of values and must be exact, a capacity may be
 *             larger than needed. NULL is allowed iff the length is 0, or where it asks for a size. Values are IEEE
 *             doubles; contact arrays go node by node, tangential components inner.
 * Texts       are UTF-8 and NUL-terminated.
 * Units       SI, per metre of depth in 2D. Every port names its own.
 * Threads     A model may be used from any number of threads at once. A simulator, and a saved state while it is
 *             saved into, is used by one thread at a time, any thread; a second call with a simulator at the same time
 *             is refused with STICKSLIP_CALL_ORDER. The last error belongs to the thread of the failed call.
 * Manners     No printing, no threads, no signals, no environment, no files but those that
 *             stickslip_model_compile_file is asked to read. No allocation in set_inputs, set, set_many,
 *             do_step (at step sizes met before), get_outputs, get, save_state, restore_state. A panic inside the library
 *             is caught: the call returns STICKSLIP_POISONED, and so does every later one with that simulator, which can
 *             only be freed. Floating-point traps, rounding mode and flushing to zero of the host are put aside for a
 *             call and are back, sticky flags included, when it returns.
 * Results are reproducible: the same calls on the same model give the same bits, in any thread.
 */

#ifndef STICKSLIP_H
#define STICKSLIP_H

#include <stddef.h>
#include <stdint.h>

// Version of this interface. It grows when a function or structure changes its meaning or layout, not when one is added.
#define STICKSLIP_ABI_VERSION 1

// The call did what it says.
#define STICKSLIP_OK 0

// The step was taken, but the multiplicity test (scene: `fidelity.multiplicity_test`) found more than one solution.
#define STICKSLIP_NOT_UNIQUE 1

// The step was taken, but rounding kept the friction law from holding to `fidelity.friction_tolerance`: the output
// `solver.residual` tells to what share of the forces that meet at a contact node it holds, never worse than 1e-8, or than what
// moves slip rates and stresses of slipping nodes by less than the tolerance.
#define STICKSLIP_AT_ROUNDING 2

// The step was taken, but displacement and slip lost more digits to rounding than `fidelity.tolerance` allows: a step of
// millions of relaxation times with trapezoid or TR-BDF2 after a jump of the loads. The output `solver.lost_digits` tells the
// share by estimate; stresses and energies may be off by some times as much. Backward Euler keeps the digits.
#define STICKSLIP_DIGITS_LOST 3

// The step was taken, but `fidelity.work_limit` ended a friction problem at its best iterate: the output `solver.residual` tells
// how well the friction law holds.
#define STICKSLIP_TRUNCATED 4

// Causality of a port: set before a step, by default its value at the end of the step (`stickslip_set_inputs_meaning`).
#define STICKSLIP_INPUT 0

// Causality of a port: read after a step.
#define STICKSLIP_OUTPUT 1

// Causality of a port: a coefficient of the friction law, may be set between steps.
#define STICKSLIP_PARAMETER 2

// Inputs set before a step are the loads at its end; within it loads go linearly from where they are (or jump at its beginning,
// with `interpolation` `hold`). The default. Exact where loads are linear over the step.
#define STICKSLIP_INPUTS_END_OF_STEP 0

// Inputs set before a step are the loads at its beginning, held over it: first order in the communication step, exact for loads
// that jump at communication points. Every change costs one more solution of the friction problem.
#define STICKSLIP_INPUTS_HOLD 1

// Inputs set before a step are the loads at its beginning, continued with the slope of the last steps (at most twice the
// slope before it, none where the two differ in sign): second order where loads are smooth, and a jump is held. Costs what
// `STICKSLIP_INPUTS_HOLD` costs.
#define STICKSLIP_INPUTS_CONTINUE 2

// Why a call failed. A code is never reused and keeps its meaning between versions.
enum stickslip_code
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The scene text is refused; the message names the JSON path.
  STICKSLIP_SCENE = -1,
  // The scene gives no usable body.
  STICKSLIP_BODY = -2,
  // The model does not reach `fidelity.tolerance`: the reduction does not, or 64-bit numbers lose more of the body.
  STICKSLIP_REDUCTION_INACCURATE = -3,
  // The friction solver did not reach its tolerance.
  STICKSLIP_NOT_CONVERGED = -4,
  // A matrix that must be positive definite is not.
  STICKSLIP_NOT_POSITIVE_DEFINITE = -5,
  // The step is not positive, or the time does not continue the simulation.
  STICKSLIP_STEP = -6,
  // An array has the wrong length.
  STICKSLIP_LENGTH = -7,
  // A number is not finite or out of its range.
  STICKSLIP_VALUE = -8,
  // A name, reference or index is unknown.
  STICKSLIP_UNKNOWN = -9,
  // The call is not allowed now.
  STICKSLIP_CALL_ORDER = -10,
  // Bytes that are no saved state or model of this version, or are damaged.
  STICKSLIP_BYTES = -11,
  // The state belongs to another model.
  STICKSLIP_FINGERPRINT = -12,
  // An explicit scheme is beyond its stability limit.
  STICKSLIP_UNSTABLE = -13,
  // A pointer is NULL that must not be.
  STICKSLIP_NULL = -14,
  // The library panicked; the simulator of the call can only be freed.
  STICKSLIP_POISONED = -15,
  // No step is small enough for `time.tolerance`.
  STICKSLIP_TOLERANCE_OUT_OF_REACH = -16,
  // The caller stopped the compilation.
  STICKSLIP_CANCELLED = -17,
  // A result is too large for a number.
  STICKSLIP_OVERFLOW = -18,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum stickslip_code stickslip_code;
#else
typedef int32_t stickslip_code;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// A compiled scene: immutable, used by any number of simulators in any number of threads.
typedef struct stickslip_model stickslip_model;

// One simulation of a model; used by one thread at a time.
typedef struct stickslip_simulator stickslip_simulator;

// Room for one saved state of a model.
typedef struct stickslip_state stickslip_state;

// Is told where a compilation stands: the phase (0: settings are measured for `fidelity.target_error`, 1: assembly, 2: the model
// of the body is made, 3: certificate), the fraction of the work that is done (0 to 1, never falling; it stays 0 in phase 0),
// and the `user_data` of the call. Any value but 0 stops the compilation. Must not throw, nor unwind by longjmp.
typedef int32_t (*stickslip_progress)(int32_t phase, double fraction, void *user_data);

// A file in memory, for `stickslip_model_compile_files`.
typedef struct stickslip_file {
  // What the scene calls it, NUL-terminated UTF-8.
  const char *name;
  // Its contents.
  const uint8_t *bytes;
  // Number of bytes.
  size_t length;
} stickslip_file;

// Sizes of a model.
typedef struct stickslip_model_info {
  // Space dimension, 2 or 3.
  size_t dimension;
  // Contact nodes.
  size_t contact_nodes;
  // Tangential components per contact node: dimension - 1.
  size_t contact_components;
  // Number of inputs: one value per load.
  size_t inputs;
  // Number of values of all outputs together.
  size_t outputs;
  // Number of ports; their references are 0, 1, ...
  size_t ports;
  // Displacements kept of the body: degrees of freedom or modes.
  size_t states;
  // Internal steps kept in the slip history.
  size_t history;
  // Bytes of a serialized state.
  size_t state_bytes;
  // Bytes held by the model of the body.
  size_t model_bytes;
  // Identifies the model: states fit models with the same fingerprint.
  uint64_t fingerprint;
  // Largest internal step, s; a communication step is cut into internal steps not larger than this.
  double largest_step;
  // By what share the slope of the friction law could grow before a step may have several solutions; negative: it may
  // have, infinite: the bound does not depend on the slip rate.
  double uniqueness_margin;
} stickslip_model_info;

// One variable.
typedef struct stickslip_port {
  // Name; belongs to the model handle, as the two texts that follow.
  const char *name;
  // SI unit, "1" for a number.
  const char *unit;
  // One sentence with sign and frame.
  const char *description;
  // What `stickslip_get` and `stickslip_set` are called with.
  uint32_t reference;
  // `STICKSLIP_INPUT`, `STICKSLIP_OUTPUT` or `STICKSLIP_PARAMETER`.
  int32_t causality;
  // 0 for a number, 1 for a vector, 2 for a table.
  size_t rank;
  // Rows and columns, the last index running fastest; 1 beyond the rank. Contact fields: nodes, then components.
  size_t shape[2];
  // Number of values: the product of the shape.
  size_t length;
  // Place of the first value in the array of `stickslip_get_outputs` (an output) or `stickslip_set_inputs` (an input).
  size_t offset;
} stickslip_port;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Version of the library, "major.minor.patch"; a static string. Any thread.
const char *stickslip_version(void);

// `STICKSLIP_ABI_VERSION` of the library: compare it with that of the header. Any thread.
uint32_t stickslip_abi_version(void);

// Compiles `scene`, the NUL-terminated UTF-8 text of a scene.json, into `*model`. Takes from milliseconds to seconds; the
// caller frees the model. Errors: `SCENE` (also for a scene that needs more memory than its `fidelity.memory_limit`, or than
// there is), `BODY`, `REDUCTION_INACCURATE`, `NOT_POSITIVE_DEFINITE`, `UNSTABLE` (unless the scene says `time.force`), `NULL`.
// Any thread.
int32_t stickslip_model_compile(const char *scene,
                                struct stickslip_model **model);

// `stickslip_model_compile` that calls `progress` some tens of times on the caller's thread, between factorizations, and stops
// when it asks for that: `*model` is then left alone. `progress` NULL: as `stickslip_model_compile`. Errors: those of
// `stickslip_model_compile`, `CANCELLED`. Any thread.
int32_t stickslip_model_compile_with(const char *scene,
                                     stickslip_progress progress,
                                     void *user_data,
                                     struct stickslip_model **model);

// `stickslip_model_compile_with` for the scene file at `path` (UTF-8), with the files of its folder: the mesh that a scene names is
// looked for there. The model keeps the bytes of what it was made from, also in `stickslip_model_save`. `progress` may be NULL. Errors:
// those of `stickslip_model_compile_with`; `SCENE` also for a scene file or a mesh file that cannot be read. Any thread.
int32_t stickslip_model_compile_file(const char *path,
                                     stickslip_progress progress,
                                     void *user_data,
                                     struct stickslip_model **model);

// `stickslip_model_compile_with` for a scene whose files are in memory: `files` are `count` of them, by the names that the scene calls
// them. Nothing of them is kept but copies of those that the scene names, in the model. `progress` may be NULL. Errors: those of
// `stickslip_model_compile_with`; `SCENE` also for a file that is not among them or cannot be used. Any thread.
int32_t stickslip_model_compile_files(const char *scene,
                                      const struct stickslip_file *files,
                                      size_t count,
                                      stickslip_progress progress,
                                      void *user_data,
                                      struct stickslip_model **model);

// Writes the derivative of all outputs at the end of the last step by its inputs, whatever
// they mean (`stickslip_set_inputs_meaning`), along `seed`:
// `derivative = (d outputs / d inputs) seed`, from the consistent tangent. `seed` has one value per input, `derivative` is
// ordered as `stickslip_get_outputs`; units are those of the output per unit of the input. Where a node is just about to
// change between stick and slip, the derivative is that of the branch the step ended on; counts and indicators have the
// derivative 0. Costs about one step, allocates, changes no state. Errors: `CALL_ORDER` when the state is not the end of a
// step (after init, reset, restore, deserialize), `LENGTH`, `VALUE`, `OVERFLOW`, `NULL`.
int32_t stickslip_directional_derivative(struct stickslip_simulator *simulator,
                                         const double *seed,
                                         size_t inputs,
                                         double *derivative,
                                         size_t outputs);

// Writes the transposed derivative of the last step: `derivative = (d outputs / d inputs)^T seed`, `seed` one value per output
// in the order of `stickslip_get_outputs`, `derivative` one per input: the gradient by the inputs of a sum of outputs weighed
// by `seed`. Made from the tangents of all inputs in one repetition of the step. Errors and cost as
// `stickslip_directional_derivative`.
int32_t stickslip_adjoint_derivative(struct stickslip_simulator *simulator,
                                     const double *seed,
                                     size_t outputs,
                                     double *derivative,
                                     size_t inputs);

// Writes the recorded past of one contact node (0, 1, ...), oldest first, one row per internal step, and the number of rows
// into `*rows`; the scene's `history.capacity` limits it. `time` (s) has one value per row; `slip_rate` (m/s), `slip` (m) and
// `tangential_stress` (Pa, on the body) have one per row and component. An array that is NULL is left out; with `capacity` 0
// only the number of rows is written. Errors: `UNKNOWN` for the node, `LENGTH` when `capacity` (in rows) is too small, `NULL`.
int32_t stickslip_slip_history(const struct stickslip_simulator *simulator,
                               size_t node,
                               double *time,
                               double *slip_rate,
                               double *slip,
                               double *tangential_stress,
                               size_t capacity,
                               size_t *rows);

// Copies the message of the last call on this thread that did not return `STICKSLIP_OK` into `buffer`, cut to
// `capacity` bytes with its terminating NUL. Returns its whole length in bytes without the NUL; 0 when there was none.
// NULL is allowed iff `capacity` is 0. A call that succeeds leaves the message alone. Any thread; never fails.
size_t stickslip_last_error(char *buffer, size_t capacity);

// Name of a code, as in the header but for the prefix ("OK", "NOT_CONVERGED", ...); "UNKNOWN_CODE" for a number that is
// none. A static string. Any thread.
const char *stickslip_code_name(int32_t code);

// Says what inputs mean, by one of the numbers `STICKSLIP_INPUTS_...`; before `stickslip_init`, and again after
// `stickslip_reset`. Without it: what `time.inputs` of the scene says, else the end of the step. Errors: `CALL_ORDER` after
// initialization, `VALUE` for another number.
int32_t stickslip_set_inputs_meaning(struct stickslip_simulator *simulator,
                                     int32_t meaning);

// Gives an input, by its reference, its slope in time (its unit per second): in the steps that follow the load is the input at
// their beginning plus slope times time, whatever inputs mean otherwise, until another slope is given or this one is cleared.
// Allocates nothing. Errors: `UNKNOWN`, `CALL_ORDER` for a port that is no input, `VALUE` for a number that is not finite; the step
// then returns `VALUE` where the slope leads out of the numbers.
int32_t stickslip_set_input_slope(struct stickslip_simulator *simulator,
                                  uint32_t reference,
                                  double slope);

// Takes the slope of an input away again. Errors: `UNKNOWN`, `CALL_ORDER` for a port that is no input.
int32_t stickslip_clear_input_slope(struct stickslip_simulator *simulator, uint32_t reference);

// Loads a compiled model from the `length` bytes of `stickslip_model_save`, without mesh or assembly, into `*model`; the
// caller frees it. The bytes are not kept. Errors: `BYTES` (of another kind or version, truncated, damaged), `FINGERPRINT`,
// `NULL`. Any thread.
int32_t stickslip_model_load(const uint8_t *bytes,
                             size_t length,
                             struct stickslip_model **model);

// Writes the model as bytes (little-endian, versioned, checksummed; the same on every machine) and their number into
// `*length`. With `bytes` NULL and `capacity` 0 only the number. Errors: `LENGTH` when `capacity` is too small, `NULL`. Any
// thread.
int32_t stickslip_model_save(const struct stickslip_model *model,
                             uint8_t *bytes,
                             size_t capacity,
                             size_t *length);

// Frees a model handle; NULL is allowed. Simulators of the model live on; the texts of its ports do not. Any thread, but
// not while another call uses the handle.
void stickslip_model_free(struct stickslip_model *model);

// Writes the sizes of a model into `*info`. Errors: `NULL`. Any thread.
int32_t stickslip_model_get_info(const struct stickslip_model *model, struct stickslip_model_info *info);

// Describes the port with that reference (0, 1, ... up to `ports` - 1) in `*port`. Errors: `UNKNOWN`, `NULL`. Any thread.
int32_t stickslip_model_get_port(const struct stickslip_model *model,
                                 uint32_t reference,
                                 struct stickslip_port *port);

// Describes the port of that name ("contact.slip_rate") in `*port`. Look up once, then use the reference. Errors:
// `UNKNOWN`, `NULL`. Any thread.
int32_t stickslip_model_find_port(const struct stickslip_model *model, const char *name, struct stickslip_port *port);

// Writes where the contact nodes are, in the order of all contact arrays: `points`, 3 coordinates per node (m; z = 0 in
// 2D), and `weights`, the share of the contact area of each node (m^2; m in 2D), which times a tangential stress is a
// force. `nodes` is the number of contact nodes. Errors: `LENGTH`, `NULL`. Any thread.
int32_t stickslip_model_get_contact(const struct stickslip_model *model, double *points, double *weights, size_t nodes);

// Creates a simulator of `model` in `*simulator`, before its initialization; the caller frees it. It keeps what it needs
// of the model alive. Errors: `NULL`, `BODY` when there is not enough memory. Any thread.
int32_t stickslip_new(const struct stickslip_model *model,
                      struct stickslip_simulator **simulator);

// Creates in `*copy` an independent simulator of the same model in the same state; the caller frees it. Errors: `NULL`,
// `POISONED`, `BODY` when there is not enough memory.
int32_t stickslip_clone(const struct stickslip_simulator *simulator, struct stickslip_simulator **copy);

// Frees a simulator, also a poisoned one; NULL is allowed. Not while another call uses it.
void stickslip_free(struct stickslip_simulator *simulator);

// Starts the simulation at `time` (s) with the body undeformed. Inputs set before are the loads at that instant; without
// them the start values of the scene are. Errors: `CALL_ORDER` when already initialized, `VALUE` for a time that is not
// finite or friction coefficients that do not fit each other, `NOT_CONVERGED`, `OVERFLOW`.
int32_t stickslip_init(struct stickslip_simulator *simulator,
                       double time);

// Back to before `stickslip_init`, with inputs and coefficients of the scene; allocates.
int32_t stickslip_reset(struct stickslip_simulator *simulator);

// Sets all inputs, `count` values in the order of the loads of the scene: the intensities at the end of the next step, or
// at its beginning where `stickslip_set_inputs_meaning` says so (before `stickslip_init`: at the start), Pa for a traction, N/m^3 for a body force. They stay until set again. Allocates
// nothing. Errors: `LENGTH`, `VALUE` for a number that is not finite, `NULL`.
int32_t stickslip_set_inputs(struct stickslip_simulator *simulator,
                             const double *values,
                             size_t count);

// Sets one input or parameter by its reference, in the unit of its port. Coefficients of the friction law may be set in any
// order: each is checked against its own range here, and the set of them (a >= b) by `stickslip_init` and
// `stickslip_do_step`. Outputs are those of the last step until the next one. Errors: `UNKNOWN`, `CALL_ORDER` for an output,
// `VALUE`, `LENGTH` for an array, which `stickslip_set_values` sets.
int32_t stickslip_set(struct stickslip_simulator *simulator,
                      uint32_t reference,
                      double value);

// Sets `count` inputs and parameters together: `values[i]` to the port `references[i]`, in its unit; of a port named twice
// the last value holds. The friction coefficients that result are checked as a set when the call ends. All is set or, on an
// error, nothing. Allocates nothing. Errors: `UNKNOWN`, `CALL_ORDER` for an output, `VALUE`, `NULL`, `LENGTH` for an array,
// which `stickslip_set_values` sets.
int32_t stickslip_set_many(struct stickslip_simulator *simulator,
                           const uint32_t *references,
                           const double *values,
                           size_t count);

// Sets inputs and parameters together, arrays included: `values` holds all values of the port `references[0]`, then those of
// `references[1]` and so on, in the units of the ports; of a port named twice the last values hold. A coefficient of friction
// that the scene gives per contact node (`{"nodes": [...]}`), and the points of a table, are arrays. The friction coefficients
// that result are checked as a set when the call ends. All is set or, on an error, nothing. Allocates nothing. Errors:
// `UNKNOWN`, `CALL_ORDER` for an output, `VALUE`, `NULL`, `LENGTH` unless there are as many values as the ports have.
int32_t stickslip_set_values(struct stickslip_simulator *simulator,
                             const uint32_t *references,
                             size_t reference_count,
                             const double *values,
                             size_t value_count);

// Steps from `time` to `time + step` (s). `time` is where the simulation stands, up to rounding; a step of any size is cut
// into internal steps. Allocates nothing once the step size is known. Returns a note (> 0) on a step that was taken, the first
// that applies: `TRUNCATED` when `fidelity.work_limit` ended a friction problem at its best iterate, `NOT_UNIQUE` when the
// multiplicity test found other solutions, `DIGITS_LOST` when rounding took more of
// displacement and slip than the tolerance of the body allows, `AT_ROUNDING` when rounding kept the friction law from holding
// to its tolerance. Errors, with the state bit for bit as before: `CALL_ORDER` before `stickslip_init`, `STEP`, `VALUE` for
// friction coefficients that do not fit each other, `NOT_CONVERGED`, `TOLERANCE_OUT_OF_REACH`, `OVERFLOW` for results that
// are too large for a number.
int32_t stickslip_do_step(struct stickslip_simulator *simulator,
                          double time,
                          double step);

// Writes all outputs, `count` values, one port after the other in the order of their references (`offset` of a port tells
// where it begins). Allocates nothing. Errors: `LENGTH`, `NULL`.
int32_t stickslip_get_outputs(const struct stickslip_simulator *simulator,
                              double *values,
                              size_t count);

// Writes the `count` values of one port (any causality) by its reference. Allocates nothing. Errors: `UNKNOWN`, `LENGTH`,
// `NULL`.
int32_t stickslip_get(const struct stickslip_simulator *simulator,
                      uint32_t reference,
                      double *values,
                      size_t count);

// Writes where the simulation stands into `*time`, s. Errors: `NULL`.
int32_t stickslip_get_time(const struct stickslip_simulator *simulator, double *time);

// Creates in `*state` room for a saved state of this simulator and of all others of its model; the caller frees it. It
// outlives simulator and model. Errors: `NULL`, `POISONED`, `BODY` when there is not enough memory.
int32_t stickslip_state_new(const struct stickslip_simulator *simulator, struct stickslip_state **state);

// Frees a saved state; NULL is allowed.
void stickslip_state_free(struct stickslip_state *state);

// Saves all that future steps depend on (inputs, coefficients, history and warm start included) into `state`, over what
// it held. Allocates nothing: cheap enough for every step. Errors: `FINGERPRINT` for the state of another model, `NULL`.
int32_t stickslip_save_state(const struct stickslip_simulator *simulator,
                             struct stickslip_state *state);

// Continues from a saved state, any number of times and in any order; the runs that follow are bit for bit those that
// followed the save. Allocates nothing. There is no step to take derivatives of until the next one. Errors: `CALL_ORDER` when
// nothing has been saved into `state`, `FINGERPRINT`, `NULL`.
int32_t stickslip_restore_state(struct stickslip_simulator *simulator,
                                const struct stickslip_state *state);

// Writes the state as bytes (little-endian, versioned, checksummed, with the fingerprint of the model) and their number
// into `*length`. With `bytes` NULL and `capacity` 0 only the number, which is the same for all states of a model. Allocates
// nothing. Errors: `LENGTH` when `capacity` is too small, `NULL`.
int32_t stickslip_serialize(const struct stickslip_simulator *simulator,
                            uint8_t *bytes,
                            size_t capacity,
                            size_t *length);

// Continues from the bytes of `stickslip_serialize`, in this process or another, on this machine or another that holds the
// same compiled model. Errors, with the state as before: `BYTES` (of another kind or version, truncated, damaged, or a state
// that no simulation leaves behind: numbers that are not finite, counters out of range), `FINGERPRINT`, `NULL`.
int32_t stickslip_deserialize(struct stickslip_simulator *simulator,
                              const uint8_t *bytes,
                              size_t length);

// Copies the message of the last call on this thread that did not return `STICKSLIP_OK` into `buffer`, cut to
// `capacity` bytes with its terminating NUL. Returns its whole length in bytes without the NUL; 0 when there was none.
// NULL is allowed iff `capacity` is 0. A call that succeeds leaves the message alone. Any thread; never fails.
size_t stickslip_last_error(char *buffer, size_t capacity);

// Name of a code, as in the header but for the prefix ("OK", "NOT_CONVERGED", ...); "UNKNOWN_CODE" for a number that is
// none. A static string. Any thread.
const char *stickslip_code_name(int32_t code);

// Loads a compiled model from the `length` bytes of `stickslip_model_save`, without mesh or assembly, into `*model`; the
// caller frees it. The bytes are not kept. Errors: `BYTES` (of another kind or version, truncated, damaged), `FINGERPRINT`,
// `NULL`. Any thread.
int32_t stickslip_model_load(const uint8_t *bytes,
                             size_t length,
                             struct stickslip_model **model);

// Writes the model as bytes (little-endian, versioned, checksummed; the same on every machine) and their number into
// `*length`. With `bytes` NULL and `capacity` 0 only the number. Errors: `LENGTH` when `capacity` is too small, `NULL`. Any
// thread.
int32_t stickslip_model_save(const struct stickslip_model *model,
                             uint8_t *bytes,
                             size_t capacity,
                             size_t *length);

// Frees a model handle; NULL is allowed. Simulators of the model live on; the texts of its ports do not. Any thread, but
// not while another call uses the handle.
void stickslip_model_free(struct stickslip_model *model);

// Writes the sizes of a model into `*info`. Errors: `NULL`. Any thread.
int32_t stickslip_model_get_info(const struct stickslip_model *model, struct stickslip_model_info *info);

// Describes the port with that reference (0, 1, ... up to `ports` - 1) in `*port`. Errors: `UNKNOWN`, `NULL`. Any thread.
int32_t stickslip_model_get_port(const struct stickslip_model *model,
                                 uint32_t reference,
                                 struct stickslip_port *port);

// Describes the port of that name ("contact.slip_rate") in `*port`. Look up once, then use the reference. Errors:
// `UNKNOWN`, `NULL`. Any thread.
int32_t stickslip_model_find_port(const struct stickslip_model *model, const char *name, struct stickslip_port *port);

// Writes where the contact nodes are, in the order of all contact arrays: `points`, 3 coordinates per node (m; z = 0 in
// 2D), and `weights`, the share of the contact area of each node (m^2; m in 2D), which times a tangential stress is a
// force. `nodes` is the number of contact nodes. Errors: `LENGTH`, `NULL`. Any thread.
int32_t stickslip_model_get_contact(const struct stickslip_model *model, double *points, double *weights, size_t nodes);

// Creates a simulator of `model` in `*simulator`, before its initialization; the caller frees it. It keeps what it needs
// of the model alive. Errors: `NULL`, `BODY` when there is not enough memory. Any thread.
int32_t stickslip_new(const struct stickslip_model *model,
                      struct stickslip_simulator **simulator);

// Creates in `*copy` an independent simulator of the same model in the same state; the caller frees it. Errors: `NULL`,
// `POISONED`, `BODY` when there is not enough memory.
int32_t stickslip_clone(const struct stickslip_simulator *simulator, struct stickslip_simulator **copy);

// Frees a simulator, also a poisoned one; NULL is allowed. Not while another call uses it.
void stickslip_free(struct stickslip_simulator *simulator);

// Starts the simulation at `time` (s) with the body undeformed. Inputs set before are the loads at that instant; without
// them the start values of the scene are. Errors: `CALL_ORDER` when already initialized, `VALUE` for a time that is not
// finite or friction coefficients that do not fit each other, `NOT_CONVERGED`, `OVERFLOW`.
int32_t stickslip_init(struct stickslip_simulator *simulator,
                       double time);

// Back to before `stickslip_init`, with inputs and coefficients of the scene; allocates.
int32_t stickslip_reset(struct stickslip_simulator *simulator);

// Sets all inputs, `count` values in the order of the loads of the scene: the intensities at the end of the next step, or
// at its beginning where `stickslip_set_inputs_meaning` says so (before `stickslip_init`: at the start), Pa for a traction, N/m^3 for a body force. They stay until set again. Allocates
// nothing. Errors: `LENGTH`, `VALUE` for a number that is not finite, `NULL`.
int32_t stickslip_set_inputs(struct stickslip_simulator *simulator,
                             const double *values,
                             size_t count);

// Sets one input or parameter by its reference, in the unit of its port. Coefficients of the friction law may be set in any
// order: each is checked against its own range here, and the set of them (a >= b) by `stickslip_init` and
// `stickslip_do_step`. Outputs are those of the last step until the next one. Errors: `UNKNOWN`, `CALL_ORDER` for an output,
// `VALUE`, `LENGTH` for an array, which `stickslip_set_values` sets.
int32_t stickslip_set(struct stickslip_simulator *simulator,
                      uint32_t reference,
                      double value);

// Sets `count` inputs and parameters together: `values[i]` to the port `references[i]`, in its unit; of a port named twice
// the last value holds. The friction coefficients that result are checked as a set when the call ends. All is set or, on an
// error, nothing. Allocates nothing. Errors: `UNKNOWN`, `CALL_ORDER` for an output, `VALUE`, `NULL`, `LENGTH` for an array,
// which `stickslip_set_values` sets.
int32_t stickslip_set_many(struct stickslip_simulator *simulator,
                           const uint32_t *references,
                           const double *values,
                           size_t count);

// Sets inputs and parameters together, arrays included: `values` holds all values of the port `references[0]`, then those of
// `references[1]` and so on, in the units of the ports; of a port named twice the last values hold. A coefficient of friction
// that the scene gives per contact node (`{"nodes": [...]}`), and the points of a table, are arrays. The friction coefficients
// that result are checked as a set when the call ends. All is set or, on an error, nothing. Allocates nothing. Errors:
// `UNKNOWN`, `CALL_ORDER` for an output, `VALUE`, `NULL`, `LENGTH` unless there are as many values as the ports have.
int32_t stickslip_set_values(struct stickslip_simulator *simulator,
                             const uint32_t *references,
                             size_t reference_count,
                             const double *values,
                             size_t value_count);

// Steps from `time` to `time + step` (s). `time` is where the simulation stands, up to rounding; a step of any size is cut
// into internal steps. Allocates nothing once the step size is known. Returns a note (> 0) on a step that was taken, the first
// that applies: `TRUNCATED` when `fidelity.work_limit` ended a friction problem at its best iterate, `NOT_UNIQUE` when the
// multiplicity test found other solutions, `DIGITS_LOST` when rounding took more of
// displacement and slip than the tolerance of the body allows, `AT_ROUNDING` when rounding kept the friction law from holding
// to its tolerance. Errors, with the state bit for bit as before: `CALL_ORDER` before `stickslip_init`, `STEP`, `VALUE` for
// friction coefficients that do not fit each other, `NOT_CONVERGED`, `TOLERANCE_OUT_OF_REACH`, `OVERFLOW` for results that
// are too large for a number.
int32_t stickslip_do_step(struct stickslip_simulator *simulator,
                          double time,
                          double step);

// Writes all outputs, `count` values, one port after the other in the order of their references (`offset` of a port tells
// where it begins). Allocates nothing. Errors: `LENGTH`, `NULL`.
int32_t stickslip_get_outputs(const struct stickslip_simulator *simulator,
                              double *values,
                              size_t count);

// Writes the `count` values of one port (any causality) by its reference. Allocates nothing. Errors: `UNKNOWN`, `LENGTH`,
// `NULL`.
int32_t stickslip_get(const struct stickslip_simulator *simulator,
                      uint32_t reference,
                      double *values,
                      size_t count);

// Writes where the simulation stands into `*time`, s. Errors: `NULL`.
int32_t stickslip_get_time(const struct stickslip_simulator *simulator, double *time);

// Says what inputs mean, by one of the numbers `STICKSLIP_INPUTS_...`; before `stickslip_init`, and again after
// `stickslip_reset`. Without it: what `time.inputs` of the scene says, else the end of the step. Errors: `CALL_ORDER` after
// initialization, `VALUE` for another number.
int32_t stickslip_set_inputs_meaning(struct stickslip_simulator *simulator,
                                     int32_t meaning);

// Gives an input, by its reference, its slope in time (its unit per second): in the steps that follow the load is the input at
// their beginning plus slope times time, whatever inputs mean otherwise, until another slope is given or this one is cleared.
// Allocates nothing. Errors: `UNKNOWN`, `CALL_ORDER` for a port that is no input, `VALUE` for a number that is not finite; the step
// then returns `VALUE` where the slope leads out of the numbers.
int32_t stickslip_set_input_slope(struct stickslip_simulator *simulator,
                                  uint32_t reference,
                                  double slope);

// Takes the slope of an input away again. Errors: `UNKNOWN`, `CALL_ORDER` for a port that is no input.
int32_t stickslip_clear_input_slope(struct stickslip_simulator *simulator, uint32_t reference);

// Creates in `*state` room for a saved state of this simulator and of all others of its model; the caller frees it. It
// outlives simulator and model. Errors: `NULL`, `POISONED`, `BODY` when there is not enough memory.
int32_t stickslip_state_new(const struct stickslip_simulator *simulator, struct stickslip_state **state);

// Frees a saved state; NULL is allowed.
void stickslip_state_free(struct stickslip_state *state);

// Saves all that future steps depend on (inputs, coefficients, history and warm start included) into `state`, over what
// it held. Allocates nothing: cheap enough for every step. Errors: `FINGERPRINT` for the state of another model, `NULL`.
int32_t stickslip_save_state(const struct stickslip_simulator *simulator,
                             struct stickslip_state *state);

// Continues from a saved state, any number of times and in any order; the runs that follow are bit for bit those that
// followed the save. Allocates nothing. There is no step to take derivatives of until the next one. Errors: `CALL_ORDER` when
// nothing has been saved into `state`, `FINGERPRINT`, `NULL`.
int32_t stickslip_restore_state(struct stickslip_simulator *simulator,
                                const struct stickslip_state *state);

// Writes the state as bytes (little-endian, versioned, checksummed, with the fingerprint of the model) and their number
// into `*length`. With `bytes` NULL and `capacity` 0 only the number, which is the same for all states of a model. Allocates
// nothing. Errors: `LENGTH` when `capacity` is too small, `NULL`.
int32_t stickslip_serialize(const struct stickslip_simulator *simulator,
                            uint8_t *bytes,
                            size_t capacity,
                            size_t *length);

// Continues from the bytes of `stickslip_serialize`, in this process or another, on this machine or another that holds the
// same compiled model. Errors, with the state as before: `BYTES` (of another kind or version, truncated, damaged, or a state
// that no simulation leaves behind: numbers that are not finite, counters out of range), `FINGERPRINT`, `NULL`.
int32_t stickslip_deserialize(struct stickslip_simulator *simulator,
                              const uint8_t *bytes,
                              size_t length);

// Writes the derivative of all outputs at the end of the last step by its inputs, whatever
// they mean (`stickslip_set_inputs_meaning`), along `seed`:
// `derivative = (d outputs / d inputs) seed`, from the consistent tangent. `seed` has one value per input, `derivative` is
// ordered as `stickslip_get_outputs`; units are those of the output per unit of the input. Where a node is just about to
// change between stick and slip, the derivative is that of the branch the step ended on; counts and indicators have the
// derivative 0. Costs about one step, allocates, changes no state. Errors: `CALL_ORDER` when the state is not the end of a
// step (after init, reset, restore, deserialize), `LENGTH`, `VALUE`, `OVERFLOW`, `NULL`.
int32_t stickslip_directional_derivative(struct stickslip_simulator *simulator,
                                         const double *seed,
                                         size_t inputs,
                                         double *derivative,
                                         size_t outputs);

// Writes the transposed derivative of the last step: `derivative = (d outputs / d inputs)^T seed`, `seed` one value per output
// in the order of `stickslip_get_outputs`, `derivative` one per input: the gradient by the inputs of a sum of outputs weighed
// by `seed`. Made from the tangents of all inputs in one repetition of the step. Errors and cost as
// `stickslip_directional_derivative`.
int32_t stickslip_adjoint_derivative(struct stickslip_simulator *simulator,
                                     const double *seed,
                                     size_t outputs,
                                     double *derivative,
                                     size_t inputs);

// Writes the recorded past of one contact node (0, 1, ...), oldest first, one row per internal step, and the number of rows
// into `*rows`; the scene's `history.capacity` limits it. `time` (s) has one value per row; `slip_rate` (m/s), `slip` (m) and
// `tangential_stress` (Pa, on the body) have one per row and component. An array that is NULL is left out; with `capacity` 0
// only the number of rows is written. Errors: `UNKNOWN` for the node, `LENGTH` when `capacity` (in rows) is too small, `NULL`.
int32_t stickslip_slip_history(const struct stickslip_simulator *simulator,
                               size_t node,
                               double *time,
                               double *slip_rate,
                               double *slip,
                               double *tangential_stress,
                               size_t capacity,
                               size_t *rows);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* STICKSLIP_H */
