/* SPDX-License-Identifier: BSD-3-Clause */
#include "mpi/transport.h"

#define _POSIX_C_SOURCE 199309L

#include <limits.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* A message on its way. Neither end waits for the other: both work on, and the library moves bytes whenever one of them
   looks for messages. */
struct message {
  struct message* next;
  MPI_Request request;
  int other, done; /* the rank at the other end */
  size_t count;
  char bytes[];
};

static struct message *sent, *coming;                /* in the order of their beginning */
static size_t const most_coming = (size_t)256 << 20; /* bytes; further messages wait at the other end */

static struct message* append(struct message** list, int other, size_t count) {
  struct message* const m = malloc(sizeof *m + count);
  if (!m) {
    fprintf(stderr, "error: no memory for a message of %zu bytes\n", count);
    MPI_Abort(MPI_COMM_WORLD, 2);
    abort();
  }
  *m = (struct message){.other = other, .count = count};
  while (*list) list = &(*list)->next;
  *list = m;
  return m;
}

static void drop(struct message** at) {
  struct message* const m = *at;
  *at = m->next;
  free(m);
}

static void send_bytes(int to, void const* bytes, size_t count) {
  if (count > INT_MAX) {
    fprintf(stderr, "error: a message of %zu bytes is more than MPI sends; use slices and straytrace merge\n", count);
    MPI_Abort(MPI_COMM_WORLD, 2);
  }
  struct message* const m = append(&sent, to, count);
  memcpy(m->bytes, bytes, count);
  MPI_Isend(m->bytes, (int)count, MPI_BYTE, to, 0, MPI_COMM_WORLD, &m->request);
}

static int progress(struct message* m) {
  if (!m->done) MPI_Test(&m->request, &m->done, MPI_STATUS_IGNORE);
  return m->done;
}

static void forget_sent(void) {
  for (struct message** at = &sent; *at;) {
    if (progress(*at))
      drop(at);
    else
      at = &(*at)->next;
  }
}

static void receive_coming(void) {
  size_t bytes = 0;
  for (struct message const* m = coming; m; m = m->next) bytes += m->count;
  while (bytes < most_coming) {
    int there = 0, count = 0;
    MPI_Message matched;
    MPI_Status status;
    MPI_Improbe(MPI_ANY_SOURCE, 0, MPI_COMM_WORLD, &there, &matched, &status);
    if (!there) return;
    MPI_Get_count(&status, MPI_BYTE, &count);
    struct message* const m = append(&coming, status.MPI_SOURCE, (size_t)count);
    MPI_Imrecv(m->bytes, count, MPI_BYTE, &matched, &m->request);
    bytes += (size_t)count;
  }
}

/* A message does not overtake an earlier one of the same rank. */
static int is_first_of_rank(struct message const* m) {
  struct message const* earlier = coming;
  while (earlier != m && earlier->other != m->other) earlier = earlier->next;
  return earlier == m;
}

static struct message** first_arrived(void) {
  forget_sent();
  receive_coming();
  for (struct message** at = &coming; *at; at = &(*at)->next)
    if (progress(*at) && is_first_of_rank(*at)) return at;
  return NULL;
}

static long next_size(int* from) {
  struct message** const at = first_arrived();
  if (!at) return -1;
  *from = (*at)->other;
  return (long)(*at)->count;
}

static void receive_bytes(int from, void* bytes, size_t count) {
  struct message** at = &coming;
  while ((*at)->other != from) at = &(*at)->next;
  memcpy(bytes, (*at)->bytes, count);
  drop(at);
}

/* Whether all ranks come to the end: MPI_Finalize would wait for ever for one that hangs. Rank 0 waits a minute, others
   for rank 0. A rank comes once its messages have left it; those that nobody needs any more are dropped. */
static int all_are_here(void) {
  MPI_Request meeting = MPI_REQUEST_NULL;
  int rank = 0, there = 0, met = 0;
  double const until = MPI_Wtime() + 60;
  struct timespec const pause = {0, 1000000};
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  for (;;) {
    for (struct message** at = first_arrived(); at; at = first_arrived()) drop(at);
    if (!met && !sent) {
      MPI_Ibarrier(MPI_COMM_WORLD, &meeting);
      met = 1;
    }
    if (met && !there) MPI_Test(&meeting, &there, MPI_STATUS_IGNORE);
    if ((there && !coming) || (rank == 0 && MPI_Wtime() > until)) return there;
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
