/* SPDX-License-Identifier: BSD-3-Clause */
#include "mpi/transport.h"

#define _POSIX_C_SOURCE 199309L

#include <limits.h>
#include <mpi.h>
#include <stdio.h>
#include <time.h>

static void send_bytes(int to, void const* bytes, size_t count) {
  if (count > INT_MAX) {
    fprintf(stderr, "error: a message of %zu bytes is more than MPI sends; use slices and straytrace merge\n", count);
    MPI_Abort(MPI_COMM_WORLD, 2);
  }
  MPI_Send(bytes, (int)count, MPI_BYTE, to, 0, MPI_COMM_WORLD);
}

static long next_size(int* from) {
  int there = 0, count = 0;
  MPI_Status status;
  MPI_Iprobe(MPI_ANY_SOURCE, 0, MPI_COMM_WORLD, &there, &status);
  if (!there) return -1;
  MPI_Get_count(&status, MPI_BYTE, &count);
  *from = status.MPI_SOURCE;
  return count;
}

static void receive_bytes(int from, void* bytes, size_t count) {
  MPI_Recv(bytes, (int)count, MPI_BYTE, from, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
}

/* Whether all ranks come to the end: MPI_Finalize would wait for ever for one that hangs. Rank 0 waits a minute, others
   for rank 0. */
static int all_are_here(void) {
  MPI_Request meeting;
  int rank = 0, there = 0;
  double const until = MPI_Wtime() + 60;
  struct timespec const pause = {0, 1000000};
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Ibarrier(MPI_COMM_WORLD, &meeting);
  for (;;) {
    MPI_Test(&meeting, &there, MPI_STATUS_IGNORE);
    if (there || (rank == 0 && MPI_Wtime() > until)) return there;
    nanosleep(&pause, NULL);
  }
}

static void close_job(int lost, int exit_code) {
  if (lost || !all_are_here()) MPI_Abort(MPI_COMM_WORLD, exit_code);
  MPI_Finalize();
}

int straytrace_transport_open(int version, struct straytrace_transport* transport) {
  if (version != straytrace_transport_version) return straytrace_transport_version;
  int provided = 0;
  MPI_Init_thread(NULL, NULL, MPI_THREAD_FUNNELED, &provided);
  if (provided < MPI_THREAD_FUNNELED) {
    fprintf(stderr, "error: this MPI library does not allow threads; use slices and straytrace merge\n");
    MPI_Abort(MPI_COMM_WORLD, 2);
  }
  MPI_Comm_rank(MPI_COMM_WORLD, &transport->rank);
  MPI_Comm_size(MPI_COMM_WORLD, &transport->size);
  transport->send = send_bytes;
  transport->next = next_size;
  transport->receive = receive_bytes;
  transport->close = close_job;
  return straytrace_transport_version;
}
