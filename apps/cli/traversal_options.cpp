#include "cli/traversal_options.h"

#include <map>
#include <vector>

namespace relumbre::cli {

namespace {

const std::map<std::string, Traversal::Kind> kPublished{
    {"restart", Traversal::Kind::kRestart},
    {"backtrack", Traversal::Kind::kBacktrack},
    {"full-stack", Traversal::Kind::kFullStack},
    {"short-stack", Traversal::Kind::kShortStack}};

}  // namespace

void add_traversal_options(CLI::App& command, TraversalOptions& options, const std::string& own,
                           const std::string& description) {
  std::vector<std::string> names{own};
  for (const auto& [name, kind] : kPublished) names.push_back(name);
  command.add_option("--traversal", options.name, description)->check(CLI::IsMember(names));
  command.add_option("--stack", options.stack_nodes, "Nodes that a short stack holds")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
}

void check_traversal_options(const CLI::App& command, const TraversalOptions& options) {
  if (command.count("--stack") > 0 && options.name != "short-stack")
    throw CLI::ValidationError("--stack", "is of --traversal short-stack");
}

std::optional<Traversal> published_traversal(const std::string& name, int stack_nodes) {
  const auto found = kPublished.find(name);
  if (found == kPublished.end()) return std::nullopt;
  return Traversal{found->second, stack_nodes};
}

}  // namespace relumbre::cli
