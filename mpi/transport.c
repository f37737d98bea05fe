/* SPDX-License-Identifier: BSD-3-Clause */
#include "mpi/transport.h"

#include <limits.h>
#include <mpi.h>
#include <stdio.h>

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

static void close_job(int lost) {
  if (lost) MPI_Abort(MPI_COMM_WORLD, 0);
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
