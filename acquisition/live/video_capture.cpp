#include "acquisition/live/video_capture.h"

#include <dlfcn.h>

#include "acquisition/live/video_module.h"
#include "core/error.h"
#include "core/printable.h"

namespace fathom {

namespace {

// Once for the program: it stays loaded. Every program that links this library knows the folder that it is in.
OpenVideo* load_module(std::string& why) {
  void* module = ::dlopen("libfathom_video.so", RTLD_NOW | RTLD_LOCAL);
  void* function = module == nullptr ? nullptr : ::dlsym(module, kOpenVideo);
  if (function == nullptr) {
    const char* error = ::dlerror();
    why = error == nullptr ? "no reason given" : error;
  }
  return reinterpret_cast<OpenVideo*>(function);
}

}  // namespace

std::unique_ptr<VideoCapture> open_video(const std::string& name, const std::string& address,
                                         const VideoOptions& options) {
  std::string why;
  static OpenVideo* const open = load_module(why);
  if (open == nullptr) {
    throw Error(printable(name) + ": the part of the program for videos cannot be loaded (" + printable(why, 200) +
                "); build or install it again");
  }
  std::unique_ptr<VideoCapture> capture(open(address, options, why));
  if (!capture) throw Error(printable(name) + ": " + why);
  return capture;
}

}  // namespace fathom
