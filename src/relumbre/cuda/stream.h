/// Streams, events and graphs that clean up after themselves.
#pragma once

#include <functional>
#include <memory>

#include <cuda_runtime_api.h>

namespace relumbre::cuda {

/// Work on a device in order. Movable.
class Stream {
 public:
  Stream();
  [[nodiscard]] cudaStream_t get() const { return stream_.get(); }
  /// Until all that was asked for is done. Throws DeviceError for what went wrong since.
  void wait() const;

 private:
  struct Destroy {
    void operator()(cudaStream_t stream) const { cudaStreamDestroy(stream); }
  };
  std::unique_ptr<CUstream_st, Destroy> stream_;
};

/// A point in a stream's work. Movable.
class Event {
 public:
  Event();
  void record(const Stream& stream) const;
  void wait() const;
  /// Makes what comes later in `stream` wait for it.
  void hold(const Stream& stream) const;
  /// Between two that were recorded; waits for the later one.
  static double seconds_between(const Event& first, const Event& last);

 private:
  struct Destroy {
    void operator()(cudaEvent_t event) const { cudaEventDestroy(event); }
  };
  std::unique_ptr<CUevent_st, Destroy> event_;
};

/// Work that was recorded once and is started with one call. Movable.
class Graph {
 public:
  Graph() = default;
  /// Records what `work` asks of the stream; nothing of it is done. The memory it touches must stay
  /// where it is as long as the graph.
  Graph(const Stream& stream, const std::function<void()>& work);
  void start(const Stream& stream) const;
  explicit operator bool() const { return exec_ != nullptr; }

 private:
  struct Destroy {
    void operator()(cudaGraphExec_t exec) const { cudaGraphExecDestroy(exec); }
  };
  std::unique_ptr<CUgraphExec_st, Destroy> exec_;
};

}  // namespace relumbre::cuda
