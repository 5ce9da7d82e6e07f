#include <gtest/gtest.h>

#include "relumbre/cuda/testing.h"
#include "relumbre/dof/cuda_test_pictures.h"
#include "relumbre/dof/depth_of_field_cuda.h"

namespace relumbre::cuda {
namespace {

using test::lens_for;
using test::made_picture;

TEST(DofCuda, MatchesCpuByEveryMethod) {
  RELUMBRE_NEEDS_DEVICE();
  for (const DofMethod method : {DofMethod::kGather, DofMethod::kLayered, DofMethod::kSpread}) {
    for (const bool behind : {false, true}) {
      for (const bool alpha : {false, true}) {
        const DepthPicture picture = made_picture({75, 41, alpha, behind});
        DofConfig config{.lens = lens_for(10, 75)};
        config.method = method;
        config.infill = !behind;
        EXPECT_LT(test::worst_difference(cuda::depth_of_field(picture, config),
                                         relumbre::depth_of_field(picture, config)),
                  3e-6)
            << "method " << static_cast<int>(method) << ", behind " << behind << ", alpha "
            << alpha;
      }
    }
  }
}

TEST(DofCuda, LayeredMatchesCpuForBlursLargerThanThePicture) {
  RELUMBRE_NEEDS_DEVICE();
  const DepthPicture picture = made_picture({33, 19, false, true});
  DofConfig config{.lens = lens_for(70, 33)};
  config.method = DofMethod::kLayered;
  EXPECT_LT(test::worst_difference(cuda::depth_of_field(picture, config),
                                   relumbre::depth_of_field(picture, config)),
            3e-6);
}

}  // namespace
}  // namespace relumbre::cuda
