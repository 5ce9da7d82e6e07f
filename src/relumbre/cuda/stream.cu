#include "relumbre/cuda/error.h"
#include "relumbre/cuda/stream.h"

namespace relumbre::cuda {

Stream::Stream() {
  cudaStream_t stream = nullptr;
  check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking));
  stream_.reset(stream);
}

void Stream::wait() const { check(cudaStreamSynchronize(get())); }

Event::Event() {
  cudaEvent_t event = nullptr;
  check(cudaEventCreateWithFlags(&event, cudaEventDefault));
  event_.reset(event);
}

void Event::record(const Stream& stream) const {
  check(cudaEventRecord(event_.get(), stream.get()));
}
void Event::wait() const { check(cudaEventSynchronize(event_.get())); }
void Event::hold(const Stream& stream) const {
  check(cudaStreamWaitEvent(stream.get(), event_.get(), 0));
}

double Event::seconds_between(const Event& first, const Event& last) {
  last.wait();
  float milliseconds = 0;
  check(cudaEventElapsedTime(&milliseconds, first.event_.get(), last.event_.get()));
  return static_cast<double>(milliseconds) * 1e-3;
}

Graph::Graph(const Stream& stream, const std::function<void()>& work) {
  check(cudaStreamBeginCapture(stream.get(), cudaStreamCaptureModeThreadLocal));
  cudaGraph_t graph = nullptr;
  try {
    work();
  } catch (...) {
    if (cudaStreamEndCapture(stream.get(), &graph) == cudaSuccess) cudaGraphDestroy(graph);
    throw;
  }
  check(cudaStreamEndCapture(stream.get(), &graph));
  cudaGraphExec_t exec = nullptr;
  const cudaError_t status = cudaGraphInstantiate(&exec, graph, 0);
  cudaGraphDestroy(graph);
  check(status);
  exec_.reset(exec);
}

void Graph::start(const Stream& stream) const { check(cudaGraphLaunch(exec_.get(), stream.get())); }

}  // namespace relumbre::cuda
