#include "hydrapod/tasks/linear.hpp"

#include <fmt/format.h>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"

namespace hydrapod::tasks {

namespace {

std::string without_ending(const std::string& path, std::string_view ending) {
  return path.ends_with(ending) ? path.substr(0, path.size() - ending.size()) : path;
}

/// In one line, which comments and headers of files are.
exchange::FileHead export_head(const Machine& machine) {
  return {.title = base::printable(
              fmt::format("{}, pose {}, {} model, hydrapod export", machine.file.machine.name,
                          machine.pose.name, dynamics::name(machine.kind)),
              std::string::npos)};
}

spatial::Vector3 interface_point(const Machine& machine, const ExportOptions& options) {
  return options.p_PQ.value_or(machine.file.machine.platform.mass_center);
}

/// What can be run beside the file; a machine that cannot be computed so has its reason in its
/// place.
template <class Measure>
exchange::Parity with_measured(exchange::Parity parity, const ExportOptions& options,
                               const Measure& measure) {
  if (!options.measure) return parity;
  try {
    for (auto& line : measure()) parity.push_back(std::move(line));
  } catch (const base::ComputationError& error) {
    parity.push_back({exchange::Held::approximate, "not measured", error.what()});
  }
  return parity;
}

/// As they stand in the files.
void read_matrices(const std::vector<std::string>& files, bool nastran,
                   exchange::Superelement& held) {
  if (nastran) {
    const auto read = exchange::read_dmig_punch(files[0], exchange::dmig_platform);
    held.M = read.M;
    held.K = read.K;
    held.C.setZero();
    if (read.C.size() > 0) held.C = read.C;
    return;
  }
  held.M = exchange::read_matrix_market(files[0]);
  held.K = exchange::read_matrix_market(files[1]);
  held.C = exchange::read_matrix_market(files[2]);
}

exchange::Parity export_modes(const Machine& machine, const ExportOptions& options) {
  data::write_modal_results(options.path,
                            exchange::modal_model(machine.file.machine, machine.pose.X_BP,
                                                  machine.kind, export_head(machine)),
                            options.format == ExportFormat::unv ? data::ModalDataset::analysis
                                                                : data::ModalDataset::shapes);
  return with_measured(exchange::modal_model_parity(machine.kind), options, [&] {
    return exchange::measured_modes(machine.file.machine, machine.pose.X_BP, machine.kind,
                                    data::read_modal_results(options.path).results);
  });
}

exchange::Parity export_state_space(const Machine& machine, const ExportOptions& options) {
  const exchange::StateSpaceOptions asked{
      .system = options.system.value_or(exchange::SystemKind::mechanics),
      .kind = machine.kind,
      .p_PQ = interface_point(machine, options),
      .pade_order = options.pade_order,
      .sample_time = options.sample_time,
      .sampled_controller = options.sampled_controller,
      .inputs = options.inputs,
      .outputs = options.outputs,
      .reduced_states = options.reduced_states};
  const auto& of_file = machine.file.machine;
  const auto& X_BP = machine.pose.X_BP;
  const auto system = exchange::state_space(of_file, X_BP, asked);
  const auto head = export_head(machine);
  if (options.format == ExportFormat::mat) {
    exchange::write_state_space_mat(options.path, system, head);
  } else if (options.format == ExportFormat::hdf5) {
    exchange::write_state_space_hdf5(options.path, system, head);
  } else if (options.format == ExportFormat::npz) {
    base::write_file_whole(options.path, exchange::state_space_npz(system, head));
  } else {
    report::Json json = options.json_head.is_null() ? report::Json::object() : options.json_head;
    json.update(exchange::state_space_json(system));
    base::write_file_whole(options.path, json.dump(1) + "\n");
  }
  return with_measured(exchange::state_space_parity(system), options, [&] {
    return exchange::measured_state_space(of_file, X_BP, asked, system);
  });
}

exchange::Parity export_superelement(const Machine& machine, const ExportOptions& options) {
  const exchange::SuperelementOptions asked{.kind = machine.kind,
                                            .p_PQ = interface_point(machine, options),
                                            .leg_modes = options.leg_modes,
                                            .free_base = options.free_base};
  const auto element = exchange::superelement(machine.file.machine, machine.pose.X_BP, asked);
  const auto head = export_head(machine);
  const bool nastran = options.format == ExportFormat::dmig;
  if (nastran) {
    base::write_file_whole(options.path, exchange::dmig_punch(element, head));
  } else {
    std::string coordinates;
    for (const auto& c : element.coordinates)
      coordinates += fmt::format("{}{} [{}]", coordinates.empty() ? "" : ", ", c.name, c.unit);
    const std::array matrices{&element.M, &element.K, &element.C};
    const auto files = export_files(options.format, options.path);
    for (std::size_t i = 0; i < files.size(); ++i)
      base::write_file_whole(
          files[i], exchange::matrix_market(*matrices[i],
                                            {head.title, fmt::format("{} in SI units", "MKC"[i]),
                                             "coordinates: " + coordinates}));
  }
  auto parity = exchange::superelement_parity(machine.file.machine, element, nastran);
  return with_measured(std::move(parity), options, [&] {
    auto held = element;
    read_matrices(export_files(options.format, options.path), nastran, held);
    return exchange::measured_superelement(machine.file.machine, machine.pose.X_BP, asked, held);
  });
}

void refuse_absent(const exchange::Parity& parity, const ExportOptions& options) {
  if (options.approximate) return;
  std::vector<base::Diagnostic> all;
  for (const auto& line : parity)
    if (line.held == exchange::Held::absent)
      all.push_back(
          {.file = fmt::format("--to {}", export_formats[static_cast<std::size_t>(options.format)]),
           .key = line.what,
           .message = line.how + "; --approximate writes the file without it"});
  if (!all.empty()) throw base::InputError(all);
}

exchange::Parity export_multibody(const Machine& machine, const ExportOptions& options) {
  const auto format = static_cast<exchange::MultibodyFormat>(static_cast<int>(options.format) -
                                                             static_cast<int>(ExportFormat::mjcf));
  const auto file =
      exchange::multibody_file(machine.file.machine, machine.pose.X_BP, machine.kind, format);
  refuse_absent(file.parity, options);
  const auto files = export_files(options.format, options.path);
  base::write_file_whole(files[0], file.text);
  if (files.size() > 1) base::write_file_whole(files[1], file.sidecar);
  return with_measured(file.parity, options, [&] {
    return exchange::measured_multibody(machine.file.machine, machine.pose.X_BP, machine.kind,
                                        format);
  });
}

exchange::Parity export_fmu(const Machine& machine, const ExportOptions& options) {
  const auto system = options.system.value_or(exchange::SystemKind::plant);
  const std::string to =
      fmt::format("--to {}", export_formats[static_cast<std::size_t>(options.format)]);
  const auto object = exchange::fmu_object_file();
  if (object.empty())
    base::refuse(to,
                 "needs the shared object hydrapod_fmu.so, which stands neither in the folder "
                 "apps/fmu of a build nor in an installation beside the program; build the target "
                 "hydrapod_fmu");
  constexpr std::size_t largest = 1U << 27U;
  const auto notices = object.substr(0, object.rfind('/') + 1) + "NOTICES.txt";
  auto fmu =
      exchange::fmu(machine.file.machine, machine.pose,
                    {.version = options.format == ExportFormat::fmu2 ? exchange::FmuVersion::fmi2
                                                                     : exchange::FmuVersion::fmi3,
                     .kind = machine.kind,
                     .hydraulics = system != exchange::SystemKind::mechanics,
                     .controlled = system == exchange::SystemKind::loop,
                     .object = base::read_file(object, largest, "the shared object of FMUs"),
                     .notices = base::read_file(notices, largest, "the licences of what FMUs hold"),
                     .sources = exchange::fmu_sources(object)},
                    export_head(machine));
  base::write_file_whole(options.path, fmu.archive);
  return fmu.parity;
}

}  // namespace

std::vector<std::string> export_files(ExportFormat format, const std::string& path) {
  if (format == ExportFormat::matrix_market) {
    const auto name = without_ending(path, ".mtx");
    return {name + ".M.mtx", name + ".K.mtx", name + ".C.mtx"};
  }
  if (format == ExportFormat::urdf) return {path, without_ending(path, ".urdf") + ".closures.json"};
  return {path};
}

Exported export_machine(const Machine& machine, const ExportOptions& options) {
  Exported result{.files = export_files(options.format, options.path)};
  switch (options.format) {
    case ExportFormat::mat:
    case ExportFormat::npz:
    case ExportFormat::json:
    case ExportFormat::hdf5:
      result.parity = export_state_space(machine, options);
      break;
    case ExportFormat::uff:
    case ExportFormat::unv:
      result.parity = export_modes(machine, options);
      break;
    case ExportFormat::matrix_market:
    case ExportFormat::dmig:
      result.parity = export_superelement(machine, options);
      break;
    case ExportFormat::fmu2:
    case ExportFormat::fmu3:
      result.parity = export_fmu(machine, options);
      break;
    default:
      result.parity = export_multibody(machine, options);
  }
  return result;
}

}  // namespace hydrapod::tasks
