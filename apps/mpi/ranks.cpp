#include "mpi/ranks.hpp"

#include <mpi.h>

namespace {
constexpr int request_tag = 1, reply_tag = 2;
}  // namespace

int hydrapod_mpi_begin(int* rank, int* size) {
  int got = 0;
  const int error = MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &got);
  if (error != MPI_SUCCESS || got < MPI_THREAD_SERIALIZED) return error != 0 ? error : 1;
  MPI_Comm_rank(MPI_COMM_WORLD, rank);
  MPI_Comm_size(MPI_COMM_WORLD, size);
  return 0;
}

std::int64_t hydrapod_mpi_least(std::int64_t value) {
  std::int64_t least = value;
  MPI_Allreduce(&value, &least, 1, MPI_INT64_T, MPI_MIN, MPI_COMM_WORLD);
  return least;
}

std::int64_t hydrapod_mpi_ask(std::int64_t request) {
  std::int64_t reply = 0;
  MPI_Send(&request, 1, MPI_INT64_T, 0, request_tag, MPI_COMM_WORLD);
  MPI_Recv(&reply, 1, MPI_INT64_T, 0, reply_tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  return reply;
}

int hydrapod_mpi_answer(std::int64_t (*reply)(std::int64_t request, void* with), void* with) {
  int waits = 0;
  MPI_Status from;
  MPI_Iprobe(MPI_ANY_SOURCE, request_tag, MPI_COMM_WORLD, &waits, &from);
  if (waits == 0) return 0;
  std::int64_t request = 0;
  MPI_Recv(&request, 1, MPI_INT64_T, from.MPI_SOURCE, request_tag, MPI_COMM_WORLD,
           MPI_STATUS_IGNORE);
  const std::int64_t answer = reply(request, with);
  MPI_Send(&answer, 1, MPI_INT64_T, from.MPI_SOURCE, reply_tag, MPI_COMM_WORLD);
  return 1;
}

void hydrapod_mpi_end() { MPI_Finalize(); }
