/// Depth of field of a picture with depth: the ladder of methods behind one call.
#pragma once

#include <string_view>
#include <vector>

#include "relumbre/base/progress.h"
#include "relumbre/dof/depth_picture.h"
#include "relumbre/dof/layered.h"
#include "relumbre/dof/spread.h"
#include "relumbre/image/thin_lens.h"

namespace relumbre {

enum class DofMethod {
  kGather,   ///< every pixel is the mean of a box as large as its own circle of confusion
  kLayered,  ///< layers by depth, each blurred by a box of one size, laid over one another
  kSpread,   ///< every pixel is spread over its own circle of confusion; see spread.h
};

struct DofConfig {
  ThinLens lens = {};
  DofMethod method = DofMethod::kSpread;
  /// The box of `gather` is as wide as the circle of confusion, that of `layered` has its area;
  /// shape and aperture are of `spread` alone, its largest diameter is of all.
  SpreadConfig spread = {};
  std::size_t layered_steps = LayeredConfig{}.layers;  ///< of `layered`; spread.layers otherwise
  /// Where the picture does not say what lies behind, guess it: see infill.h. Not for `gather`.
  bool infill = false;
};

/// Premultiplied colours. What the picture has behind its front is used by `layered` and `spread`.
/// Throws what DepthPicture::check() and ThinLens::check() throw; Cancelled.
std::vector<Rgba> depth_of_field(const DepthPicture& picture, const DofConfig& config,
                                 Progress& progress = no_progress());

}  // namespace relumbre
