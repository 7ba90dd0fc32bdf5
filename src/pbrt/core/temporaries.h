#pragma once
#include <string>

namespace pbrt {

/// While the object lives, a file or folder of that name goes if a signal ends the process (RemoveTemporaries). It does
/// not remove anything itself.
class Temporary {
  public:
    explicit Temporary(std::string path);
    ~Temporary();
    Temporary(const Temporary &) = delete;
    Temporary &operator=(const Temporary &) = delete;

  private:
    std::string path_;
};

/// Removes what living Temporary objects name, folders with all that is in them. For a process that is about to end:
/// from now on whoever makes or destroys a Temporary waits for ever.
void RemoveTemporaries();

}  // namespace pbrt
