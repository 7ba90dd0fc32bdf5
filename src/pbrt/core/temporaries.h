#pragma once
#include <string>

namespace pbrt {

/// Registers a file or folder that RemoveTemporaries deletes if a signal ends the process during this object's
/// lifetime. The destructor deletes nothing.
class Temporary {
  public:
    explicit Temporary(std::string path);
    ~Temporary();
    Temporary(const Temporary &) = delete;
    Temporary &operator=(const Temporary &) = delete;

  private:
    std::string path_;
};

/// Deletes all registered files, and folders with their content. Only before process exit: afterwards, creating or
/// destroying a Temporary blocks forever.
void RemoveTemporaries();

}  // namespace pbrt
