/// --traversal and --stack: one of the published traversals, or a command's own.
#pragma once

#include <optional>
#include <string>

#include "cli/command.h"
#include "relumbre/octree/traverse.h"

namespace relumbre::cli {

struct TraversalOptions {
  std::string name;
  int stack_nodes = 4;
};

/// `own`: the name of the command's own traversal, which is none of the published ones.
void add_traversal_options(CLI::App& command, TraversalOptions& options, const std::string& own,
                           const std::string& description);

/// Throws CLI::ValidationError for --stack without a short stack.
void check_traversal_options(const CLI::App& command, const TraversalOptions& options);

/// The published traversal of this name; none for any other name.
std::optional<Traversal> published_traversal(const std::string& name, int stack_nodes);

}  // namespace relumbre::cli
