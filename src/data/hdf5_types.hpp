#pragma once
/// What an open HDF5 file holds: the kinds of numbers and how many.

#include <hdf5.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "notes.hpp"
#include "variable_file.hpp"

namespace hydrapod::data {

/// Numbers, booleans as h5py writes them (an enumeration) and as PyTables does (eight bits).
bool is_numeric(hid_t type);
/// As h5py and MATLAB write complex numbers.
bool is_complex(hid_t type);
/// Of a table.
std::string member_name(hid_t type, unsigned member);
/// All sizes of a dataset, the fastest index first.
std::vector<std::uint64_t> sizes_of(hid_t set);
/// From an attribute; empty: none.
std::string unit_of(hid_t set);

/// What stands in an open HDF5 file of `bytes` bytes.
std::unique_ptr<VariableFile> hdf5_variables(hid_t file, std::uint64_t bytes, Notes& notes);

}  // namespace hydrapod::data
