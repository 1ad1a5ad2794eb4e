#include <fmt/format.h>

#include <algorithm>

#include "formats.hpp"
#include "spool.hpp"
#include "uff_geometry.hpp"
#include "uff_text.hpp"

namespace hydrapod::data {

namespace {

UffFunction function_of(const RecordHeader& header, std::size_t index, std::uint64_t samples,
                        bool binary) {
  const Channel& channel = header.channels[index];
  UffFunction f;
  f.id = {channel.name, header.title, uff_date(header.date),
          fmt::format("{} of repeat {}", role_text(channel.role), header.repeat), "NONE"};
  put_id_lines(channel.id_lines, f.id);
  f.type = uff_function::time_response;
  f.number = static_cast<long long>(index + 1);
  f.version = std::min(header.repeat, 99999);
  f.response = uff_place(channel);
  f.declared = samples;
  f.first = header.start;
  f.step = 1.0 / header.sample_rate;
  f.abscissa = {.quantity = uff_quantity::time, .label = "Time", .unit = "s"};
  f.ordinate = uff_axis_of(channel.name, channel.unit);
  f.binary = binary;
  return f;
}

class UffWriter final : public RecordWriter {
 public:
  UffWriter(const std::string& path, const RecordHeader& header, bool binary)
      : RecordWriter(header, binary),
        part_(path),
        header_(header),
        binary_(binary),
        spool_(part_, header) {}

  void write(const Eigen::Ref<const Samples>& samples) override {
    constexpr std::uint64_t most = 2'147'483'647;  // I10 as other programs read it
    if (spool_.samples() + static_cast<std::uint64_t>(samples.rows()) > most)
      throw base::ComputationError("a Universal File holds at most 2147483647 samples per channel");
    spool_.append(samples);
  }

 private:
  std::string finish(bool complete) override {
    std::string comments = comment_lines(header_);
    if (binary_) comments += fmt::format("# {}: {}\n", checksum_name, checksum());  // else rounded
    const std::string beginning =
        uff_beginning(header_.title, header_.date, comments) + uff_geometry_text(header_.geometry);
    replace_part(part_, spool_.samples() > 0, [&](OutStream& file) {
      bool good = file.write(beginning);
      for (std::size_t c = 0; c < header_.channels.size() && good; ++c)
        good = write_channel(c, file);
      return good;
    });
    return part_.commit(complete);
  }

  bool write_channel(std::size_t index, OutStream& file) {
    const UffFunction f = function_of(header_, index, spool_.samples(), binary_);
    std::string text = uff_function_head(f);
    UffNumbers numbers(f);
    bool good = true;
    spool_.channel(index, [&](const double* values, std::size_t count) {
      for (std::size_t i = 0; i < count; ++i) numbers.add(values[i], text);
      good = good && file.write(text);
      text.clear();
    });
    numbers.finish(text);
    return good && file.write(text);
  }

  base::PartFile part_;
  RecordHeader header_;
  bool binary_;
  Spool spool_;
};

}  // namespace

std::unique_ptr<RecordWriter> make_uff_writer(const std::string& path, const RecordHeader& header,
                                              bool binary) {
  return std::make_unique<UffWriter>(path, header, binary);
}

}  // namespace hydrapod::data
