#pragma once
/// Numbers of the MAT-file format, version 5 (MathWorks, "MAT-File Format").

#include <array>
#include <cstddef>
#include <cstdint>

namespace hydrapod::data {

inline constexpr std::size_t mat5_header_bytes = 128;

namespace mat5_type {  // of data elements
inline constexpr std::uint32_t int8 = 1, uint8 = 2, int16 = 3, uint16 = 4, int32 = 5, uint32 = 6,
                               single_float = 7, double_float = 9, int64 = 12, uint64 = 13,
                               matrix = 14, compressed = 15, utf8 = 16, utf16 = 17, utf32 = 18;
}
namespace mat5_class {  // of arrays
inline constexpr std::uint32_t cell = 1, structure = 2, object = 3, character = 4, sparse = 5,
                               double_float = 6, uint64 = 15;
}

/// Bytes of one item of a numeric type; 0 for a type that holds no numbers.
constexpr std::size_t mat5_item_bytes(std::uint32_t type) {
  constexpr std::array<std::uint8_t, 19> bytes{0, 1, 1, 2, 2, 4, 4, 4, 0, 8,
                                               0, 0, 8, 8, 0, 0, 1, 2, 4};
  return type < bytes.size() ? bytes[type] : 0;
}

}  // namespace hydrapod::data
