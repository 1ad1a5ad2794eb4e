#pragma once
/// What apps/mpi gives to the program. Functions of C: they are found by their names.

#include <cstdint>

extern "C" {

/// Begins; rank and size of the job. 0, or an error of MPI.
int hydrapod_mpi_begin(int* rank, int* size);
/// The least of the values of all ranks.
std::int64_t hydrapod_mpi_least(std::int64_t value);
/// What rank 0 answers to `request`; on all ranks but that.
std::int64_t hydrapod_mpi_ask(std::int64_t request);
/// Answers one request that waits by `reply`; 0 where none does. On rank 0, by one thread at a
/// time.
int hydrapod_mpi_answer(std::int64_t (*reply)(std::int64_t request, void* with), void* with);
/// Ends; waits for all ranks. Not twice.
void hydrapod_mpi_end();
}
