#pragma once
#include <string>

namespace pbrt {

/// Registers a file or folder that is deleted if a signal ends the process while the object lives (RemoveTemporaries).
/// The object itself deletes nothing.
class Temporary {
  public:
    explicit Temporary(std::string path);
    ~Temporary();
    Temporary(const Temporary &) = delete;
    Temporary &operator=(const Temporary &) = delete;

  private:
    std::string path_;
};

/// Deletes the files and folders of all living Temporary objects, folders with their content. Only for a process that
/// is about to end: afterwards, a thread that makes or destroys a Temporary waits for ever.
void RemoveTemporaries();

}  // namespace pbrt
