#include "hydrapod/options.hpp"

#include <CLI/CLI.hpp>
#include <utility>

namespace hydrapod::cli {

Option Option::required() { return Option(option_->required()); }
Option Option::capture_default_str() { return Option(option_->capture_default_str()); }
Option Option::type_name(const std::string& name) { return Option(option_->type_name(name)); }
Option Option::allow_extra_args(bool allow) { return Option(option_->allow_extra_args(allow)); }
Option Option::range(int least, int most) {
  return Option(option_->check(CLI::Range(least, most)));
}
Option Option::range(double least, double most) {
  return Option(option_->check(CLI::Range(least, most)));
}
Option Option::range(std::uint64_t least, std::uint64_t most) {
  return Option(option_->check(CLI::Range(least, most)));
}

Option Command::add_option(const std::string& names, std::string& value,
                           const std::string& description) {
  return Option(app_->add_option(names, value, description));
}
Option Command::add_option(const std::string& names, std::vector<std::string>& value,
                           const std::string& description) {
  return Option(app_->add_option(names, value, description));
}
Option Command::add_option(const std::string& names, int& value, const std::string& description) {
  return Option(app_->add_option(names, value, description));
}
Option Command::add_option(const std::string& names, std::uint64_t& value,
                           const std::string& description) {
  return Option(app_->add_option(names, value, description));
}
Option Command::add_option(const std::string& names, double& value,
                           const std::string& description) {
  return Option(app_->add_option(names, value, description));
}
Option Command::add_option(const std::string& names, std::optional<int>& value,
                           const std::string& description) {
  return Option(app_->add_option(names, value, description));
}
Option Command::add_option(const std::string& names, std::optional<double>& value,
                           const std::string& description) {
  return Option(app_->add_option(names, value, description));
}
void Command::add_flag(const std::string& names, bool& value, const std::string& description) {
  app_->add_flag(names, value, description);
}

Command Command::add_subcommand(const std::string& name, const std::string& description) {
  return Command(app_->add_subcommand(name, description));
}
void Command::require_subcommand(int count) { app_->require_subcommand(count); }
void Command::footer(const std::string& text) { app_->footer(text); }
std::string Command::get_footer() const { return app_->get_footer(); }
void Command::callback(std::function<void()> run) { app_->callback(std::move(run)); }

}  // namespace hydrapod::cli
