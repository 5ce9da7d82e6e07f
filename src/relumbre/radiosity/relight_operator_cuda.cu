#include <vector>

#include "relumbre/cuda/device.h"
#include "relumbre/radiosity/count_matrix.h"
#include "relumbre/radiosity/operator_input.h"
#include "relumbre/radiosity/patch_transport.h"
#include "relumbre/radiosity/relight_cuda.h"
#include "relumbre/radiosity/relight_operator_cuda.h"
#include "relumbre/radiosity/segment_mean.h"

namespace relumbre::cuda {

namespace {

const OperatorInput& checked(const OperatorInput& input) {
  check_operator_input(input);
  return input;
}

class CudaOperator final : public EditableOperator {
 public:
  CudaOperator(const OperatorInput& input, CountFormat format, int device)
      : device_(device),
        counts_(checked(input).counts, format),
        mean_(input.patch_offsets, input.area),
        relight_(make(input, format)) {}

  [[nodiscard]] std::size_t elements() const override { return relight_.elements(); }
  [[nodiscard]] std::size_t patches() const override { return relight_.patches(); }
  [[nodiscard]] std::string_view name() const override { return relight_.name(); }
  [[nodiscard]] std::size_t bytes_per_apply() const override { return relight_.bytes_per_apply(); }

  void set_reflectance(std::span<const Rgb> reflectance) override {
    check_reflectance(reflectance, elements());
    const Transport transport(*this, reflectance);
    relight_.set_reflectance(reflectance, transport.channels());
  }

 private:
  /// M − I of all channels.
  class Transport {
   public:
    Transport(const CudaOperator& of, std::span<const Rgb> reflectance) {
      for (std::size_t c = 0; c < 3; ++c)
        matrix_[c] = interreflections(of.counts_, of.mean_, reflectance, c);
    }
    [[nodiscard]] std::array<std::span<const double>, 3> channels() const {
      return {matrix_[0], matrix_[1], matrix_[2]};
    }

   private:
    std::array<std::vector<double>, 3> matrix_;
  };

  DeviceRelight make(const OperatorInput& input, CountFormat format) {
    const UseDevice use(device_);
    const Transport transport(*this, input.reflectance);
    return {{input.counts, input.patch_offsets, mean_.weights(), input.reflectance,
             transport.channels()},
            format};
  }

  void apply_checked(std::span<const float> emission, std::span<float> radiosity,
                     std::size_t sources) const override {
    relight_.apply(emission, radiosity, sources);
  }

  int device_;
  CountMatrix counts_;
  SegmentMean mean_;
  DeviceRelight relight_;
};

}  // namespace

std::unique_ptr<EditableOperator> make_compressed_operator(const OperatorInput& input,
                                                           CountFormat format, int device) {
  return std::make_unique<CudaOperator>(input, format, device);
}

}  // namespace relumbre::cuda
