/* SPDX-License-Identifier: BSD-3-Clause */
/* Interface of straytrace-mpi.so. The program loads it on demand and does not use MPI itself. */
#ifndef STRAYTRACE_TRANSPORT_H
#define STRAYTRACE_TRANSPORT_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { straytrace_transport_version = 4 };

/* All of them are called by one thread. Errors end the job, with a message of the MPI library. */
struct straytrace_transport {
  int rank, size;
  /* Does not wait: the bytes are copied, and move while the ranks look for messages. */
  void (*send)(int to, void const* bytes, size_t count);
  /* Size of the next message that has come, whole, and its sender; -1: none. */
  long (*next)(int* from);
  void (*receive)(int from, void* bytes, size_t count);
  /* Leaves the job. `lost`: a rank does not answer; then all of the job ends here, with `exit_code`. Also where this is
     rank 0 and others do not come here within a minute. */
  void (*close)(int lost, int exit_code);
};

/* Joins the job. `version`: straytrace_transport_version of the caller; returns the version of the library, and does
   nothing when they differ. */
int straytrace_transport_open(int version, struct straytrace_transport* transport);

#ifdef __cplusplus
}
#endif

#endif
