/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The library of straytrace for C, and for languages that call C: the functions of straytrace.hpp.
 *
 * A function that fails returns NULL and sets straytrace_error() of its thread. Objects are freed by the function of
 * their type. Texts and arrays belong to the object that gave them, the text of an error to the thread until its next
 * error. Tables are JSON: null stands for a number that is not known.
 */
#pragma once

#include <stddef.h>
#include <stdint.h>

#define STRAYTRACE_C __attribute__((visibility("default")))

#ifdef __cplusplus
extern "C" {
#endif

typedef struct straytrace_model straytrace_model;
typedef struct straytrace_run straytrace_run;
typedef struct straytrace_noise straytrace_noise;

/** As the exit codes of the commands. */
enum { STRAYTRACE_OTHER_ERROR = 1, STRAYTRACE_INPUT_ERROR = 2, STRAYTRACE_NUMERICAL_ERROR = 3 };

STRAYTRACE_C char const* straytrace_version(void);

STRAYTRACE_C int straytrace_error(void);              /**< kind of the last error of this thread */
STRAYTRACE_C char const* straytrace_error_text(void); /**< as the commands print it */
STRAYTRACE_C char const* straytrace_error_table(
    void); /**< its problems, a JSON list as that of `check --format json` */

/** Reads the scene `file`, or `text` in its place unless that is NULL. `set`: values such as "rim=48cm", NULL after the
 * last; or NULL. */
STRAYTRACE_C straytrace_model* straytrace_read(char const* file, char const* text, char const* const* set);
STRAYTRACE_C char const* straytrace_model_about(straytrace_model const*); /**< title, hash, bodies, ports ... */
STRAYTRACE_C void straytrace_free_model(straytrace_model*);

typedef struct {
  uint64_t histories, wanted_histories; /**< until the next check of the stop rule */
  double seconds, histories_per_s;
  double error, wanted_error; /**< relative; NaN before the first check; 0: the rule names no error */
} straytrace_progress;

typedef struct {
  uint64_t const* seed; /**< NULL: of the scene */
  uint64_t histories;   /**< 0: of the scene */
  char const* until;    /**< stop rule; NULL: of the scene */
  unsigned threads;     /**< 0: all cores */
  double max_seconds;   /**< 0: no limit */
  /** Called some times a second by the calling thread; 0 ends the trace with a valid result. May be NULL. */
  int (*progress)(straytrace_progress const*, void* context);
  void* context;
} straytrace_trace_settings;

/** Traces the light; `settings` may be NULL. */
STRAYTRACE_C straytrace_run* straytrace_trace(straytrace_model const*, straytrace_trace_settings const* settings);
STRAYTRACE_C straytrace_run* straytrace_open(char const* file);
/** Writes a run file; the returned run is the same one, NULL after an error. */
STRAYTRACE_C straytrace_run const* straytrace_save(straytrace_run const*, char const* file);
STRAYTRACE_C char const* straytrace_run_about(straytrace_run const*); /**< title, seed, histories, complete, warnings */
STRAYTRACE_C void straytrace_free_run(straytrace_run*);

/** Strain noise, with the motion of a file, or of `motion_text` in its place, unless `motion` is NULL. `set`:
 * "steel=x2" and other inputs, NULL after the last; or NULL. */
STRAYTRACE_C straytrace_noise* straytrace_project(straytrace_run const*, char const* motion, char const* motion_text,
                                                  char const* const* set);
STRAYTRACE_C char const* straytrace_noise_about(straytrace_noise const*); /**< headline, unresolved, warnings, design */
/** An array of the noise, its length in `size`: "edges", "frequency" [Hz], "asd", "sigma", "input_low", "input_high",
 * and by its name a design curve [1/sqrt(Hz)]. NULL where there is none of this name. */
STRAYTRACE_C double const* straytrace_array(straytrace_noise const*, char const* name, size_t* size);
/** The ranked paths with their strain at `count` frequencies [Hz], with shares of the band low to high (0, 0: the whole
 * grid): a list per column of straytrace::api::Path. */
STRAYTRACE_C char const* straytrace_paths(straytrace_noise*, double const* frequencies, size_t count, double low,
                                          double high);
STRAYTRACE_C void straytrace_free_noise(straytrace_noise*);

#ifdef __cplusplus
}
#endif
