#pragma once
/// Layout of RPC III files, time histories of servo-hydraulic test rigs. docs/rpc-iii.md describes
/// it.

#include <cstddef>
#include <cstdint>

namespace hydrapod::data {

inline constexpr std::size_t rpc_block_bytes = 512;
inline constexpr std::size_t rpc_record_bytes = 128;  ///< of one key and its value
inline constexpr std::size_t rpc_key_bytes = 32;      ///< with the zero behind it
inline constexpr std::size_t rpc_value_bytes = rpc_record_bytes - rpc_key_bytes;
inline constexpr std::size_t rpc_records_per_block = rpc_block_bytes / rpc_record_bytes;
inline constexpr std::size_t rpc_most_records = 1024;  ///< that the format allows in a header
inline constexpr std::size_t rpc_most_channels = 128;
inline constexpr int rpc_full_scale = 32752;  ///< where INT_FULL_SCALE says nothing

/// 0 as long as more samples may come: a part of a killed run has it.
inline constexpr const char* rpc_completed_key = "COMPLETED";

/// Keys of hydrapod's own: HYDRAPOD_1, HYDRAPOD_2 … hold the header of the record as text.
inline constexpr const char* rpc_own_key = "HYDRAPOD_";

}  // namespace hydrapod::data
