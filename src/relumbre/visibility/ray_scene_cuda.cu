#include <algorithm>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "relumbre/cuda/device.h"
#include "relumbre/cuda/launch.cuh"
#include "relumbre/cuda/memory.h"
#include "relumbre/visibility/bvh_cuda.h"
#include "relumbre/visibility/bvh_tracer.h"
#include "relumbre/visibility/ray_scene_cuda.h"

namespace relumbre::cuda {

namespace {

constexpr unsigned kThreads = 128;
/// Rays in one go: enough to fill the largest device several times over.
constexpr std::size_t kBatch = std::size_t{1} << 18;
/// A trip to the device takes as long as so few on the CPU.
constexpr std::size_t kTooFew = 1024;

__device__ __forceinline__ BvhRay load_ray(const BvhRay* ray) {
  const auto* words = reinterpret_cast<const Words4*>(ray);
  const Words4 a = load_words(words), b = load_words(words + 1);
  return {float_of_bits(a.x), float_of_bits(a.y), float_of_bits(a.z), float_of_bits(a.w),
          float_of_bits(b.x), float_of_bits(b.y), float_of_bits(b.z), float_of_bits(b.w)};
}

/// One thread a ray.
__global__ void __launch_bounds__(kThreads)
    find_closest(BvhView scene, const BvhRay* rays, BvhHit* hits, unsigned count) {
  const unsigned i = blockIdx.x * kThreads + threadIdx.x;
  if (i < count) hits[i] = trace<false>(scene, load_ray(rays + i));
}

__global__ void __launch_bounds__(kThreads)
    find_occluded(BvhView scene, const BvhRay* rays, std::uint8_t* blocked, unsigned count) {
  const unsigned i = blockIdx.x * kThreads + threadIdx.x;
  if (i < count) blocked[i] = trace<true>(scene, load_ray(rays + i)).hit() ? 1 : 0;
}

/// A thread's way to the device and back. Occlusion is brought in the room for hits.
class Lane {
 public:
  static constexpr std::size_t kDeviceBytes = kBatch * (sizeof(BvhRay) + sizeof(BvhHit));

  Lane() : rays_(kBatch), hits_(kBatch), device_rays_(kBatch), device_hits_(kBatch) {}
  ~Lane() {  // after an error the device may still write
    try {
      stream_.wait();
    } catch (const Error&) {  // was reported by the call that failed
    }
  }
  Lane(const Lane&) = delete;
  Lane& operator=(const Lane&) = delete;

  void closest(const BvhView& scene, std::span<const Ray> rays, std::span<Hit> hits) {
    send(rays);
    launch(find_closest, grid(rays.size()), stream_, scene, device_rays_.data(),
           device_hits_.data(), static_cast<unsigned>(rays.size()));
    copy_to_host<BvhHit>(device_hits_.data(), values_of(hits_).first(rays.size()), stream_);
    stream_.wait();
    std::transform(hits_.data(), hits_.data() + rays.size(), hits.begin(), from_bvh);
  }

  void occluded(const BvhView& scene, std::span<const Ray> rays, std::span<std::uint8_t> blocked) {
    send(rays);
    auto* on_device = reinterpret_cast<std::uint8_t*>(device_hits_.data());
    auto* on_host = reinterpret_cast<std::uint8_t*>(hits_.data());
    launch(find_occluded, grid(rays.size()), stream_, scene, device_rays_.data(), on_device,
           static_cast<unsigned>(rays.size()));
    copy_to_host<std::uint8_t>(on_device, {on_host, rays.size()}, stream_);
    stream_.wait();
    std::copy_n(on_host, rays.size(), blocked.begin());
  }

 private:
  static Grid grid(std::size_t rays) {
    return {.blocks = static_cast<unsigned>((rays + kThreads - 1) / kThreads), .threads = kThreads};
  }
  void send(std::span<const Ray> rays) {
    std::transform(rays.begin(), rays.end(), rays_.data(), to_bvh);
    copy_to_device<BvhRay>(values_of(rays_).first(rays.size()), device_rays_.data(), stream_);
  }

  Stream stream_;
  PinnedArray<BvhRay> rays_;
  PinnedArray<BvhHit> hits_;
  DeviceArray<BvhRay> device_rays_;
  DeviceArray<BvhHit> device_hits_;
};

/// Hands out lanes; as many are made as are ever in use at once.
class Lanes {
 public:
  template <class Use>
  void with_lane(Use&& use) {
    std::unique_ptr<Lane> lane = take();
    use(*lane);
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(lane));
  }

 private:
  std::unique_ptr<Lane> take() {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        std::unique_ptr<Lane> lane = std::move(idle_.back());
        idle_.pop_back();
        return lane;
      }
    }
    expect_free(Lane::kDeviceBytes, "a batch of rays");
    return std::make_unique<Lane>();
  }

  std::mutex mutex_;
  std::vector<std::unique_ptr<Lane>> idle_;
};

class CudaTracer final : public RayTracer {
 public:
  CudaTracer(const TriangleMesh& mesh, int device)
      : on_cpu_(mesh), device_(device), on_device_(upload(on_cpu_.bvh(), device)) {}

  [[nodiscard]] Hit closest(const Ray& ray) const override { return on_cpu_.closest(ray); }
  [[nodiscard]] bool occluded(const Ray& ray) const override { return on_cpu_.occluded(ray); }
  void closest(const RayPacket& rays, HitPacket& hits, std::size_t active) const override {
    on_cpu_.closest(rays, hits, active);
  }

  void closest(std::span<const Ray> rays, std::span<Hit> hits) const override {
    if (rays.size() < kTooFew) return on_cpu_.closest(rays, hits);
    in_batches(rays, hits, [this](Lane& lane, std::span<const Ray> some, std::span<Hit> found) {
      lane.closest(on_device_.view(), some, found);
    });
  }
  void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const override {
    if (rays.size() < kTooFew) return on_cpu_.occluded(rays, blocked);
    in_batches(rays, blocked,
               [this](Lane& lane, std::span<const Ray> some, std::span<std::uint8_t> found) {
                 lane.occluded(on_device_.view(), some, found);
               });
  }

  [[nodiscard]] std::size_t preferred_batch() const override { return kBatch; }
  [[nodiscard]] std::size_t bytes() const override { return on_cpu_.bytes() + on_device_.bytes(); }

 private:
  static DeviceBvh upload(const Bvh& bvh, int device) {
    const UseDevice use(device);
    expect_free(bvh.bytes(), "bounding volume hierarchy");
    return DeviceBvh(bvh, Stream());
  }

  template <class Result, class Trace>
  void in_batches(std::span<const Ray> rays, std::span<Result> results, Trace&& trace) const {
    const UseDevice use(device_);
    lanes_.with_lane([&](Lane& lane) {
      for (std::size_t first = 0; first < rays.size(); first += kBatch) {
        const std::size_t count = std::min(kBatch, rays.size() - first);
        trace(lane, rays.subspan(first, count), results.subspan(first, count));
      }
    });
  }

  BvhTracer on_cpu_;
  int device_;
  DeviceBvh on_device_;
  mutable Lanes lanes_;
};

}  // namespace

RayScene make_ray_scene(const TriangleMesh& mesh, int device) {
  return RayScene(std::make_unique<CudaTracer>(mesh, device), ray_epsilon(mesh));
}

}  // namespace relumbre::cuda
