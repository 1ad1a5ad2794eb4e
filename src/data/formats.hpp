#pragma once
/// The readers and writers behind record_io.hpp, one pair per format.

#include <memory>
#include <string>

#include "hydrapod/base/file.hpp"
#include "hydrapod/data/record_io.hpp"

namespace hydrapod::data {

std::unique_ptr<RecordWriter> make_csv_writer(const std::string& path, const RecordHeader& header);
std::unique_ptr<RecordWriter> make_hdf5_writer(const std::string& path, const RecordHeader& header);
std::unique_ptr<RecordWriter> make_mat5_writer(const std::string& path, const RecordHeader& header);
std::unique_ptr<RecordWriter> make_mat73_writer(const std::string& path,
                                                const RecordHeader& header);
std::unique_ptr<RecordWriter> make_uff_writer(const std::string& path, const RecordHeader& header,
                                              bool binary);

std::unique_ptr<RecordReader> make_mat5_reader(const std::string& path, const ReadOptions& options);
std::unique_ptr<RecordReader> make_uff_reader(const std::string& path, const ReadOptions& options);
std::unique_ptr<RecordReader> make_csv_reader(const std::string& path, const ReadOptions& options);
std::unique_ptr<RecordReader> make_hdf5_reader(const std::string& path, const ReadOptions& options);

/// Throws std::invalid_argument unless `samples` has a column per channel.
void require_columns(const Eigen::Ref<const Samples>& samples, const RecordHeader& header);

/// What to say when `part` cannot be written to. With samples in it the part is kept, and the
/// message names it.
std::string failed_write(base::PartFile& part, bool holds_samples);

/// Words of the files that hydrapod writes.
inline constexpr const char* record_mark = "hydrapod record";
inline constexpr int record_version = 1;

}  // namespace hydrapod::data
