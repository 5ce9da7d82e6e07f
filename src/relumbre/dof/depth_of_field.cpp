#include "relumbre/dof/depth_of_field.h"

#include "relumbre/dof/gather.h"
#include "relumbre/dof/infill.h"

namespace relumbre {

std::vector<Rgba> depth_of_field(const DepthPicture& picture, const DofConfig& config,
                                 Progress& progress) {
  picture.check();
  config.lens.check();
  if (config.method == DofMethod::kGather)
    return gather(picture, config.lens, config.spread.largest_diameter);
  if (config.infill && !picture.has_behind()) {
    DofConfig as_it_is = config;
    as_it_is.infill = false;
    return depth_of_field(infilled(picture, config.lens, config.spread.largest_diameter), as_it_is,
                          progress);
  }
  if (config.method == DofMethod::kLayered) {
    return layered(picture, config.lens, {config.layered_steps, config.spread.largest_diameter},
                   progress);
  }
  return spread(picture, config.lens, config.spread, progress);
}

}  // namespace relumbre
