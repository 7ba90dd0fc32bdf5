#pragma once
#include <memory>

#include "pbrt/build/built_scene.h"
#include "pbrt/cmd/pbrt/command_line.h"
#include "pbrt/core/state_file.h"

namespace pbrt {

/// The files of --save-lights and --load-lights: records of a light sampler and a guide for other renders.
class LearnedLights {
  public:
    /// Reads the file to be loaded. Throws UserError if it is damaged, or if the other one cannot be written.
    static LearnedLights Open(const CommandLine &options);

    bool AreUsed() const { return loaded_ || !savePath_.empty(); }
    bool AreLoaded() const { return loaded_ != nullptr; }
    /// Hash of the content of the loaded file; empty if there is none.
    std::string Hash() const;
    /// Checks that the sampler learns, and that the loaded file fits the built scene. Throws UserError.
    void Check(const BuiltScene &built) const;
    StateReader Learned() const { return {loaded_->Section("learned"), loaded_->Path()}; }
    /// Writes the records after the render. Throws UserError.
    void Save(const BuiltScene &built) const;
    const std::string &SavePath() const { return savePath_; }

  private:
    LearnedLights() = default;
    std::string savePath_;
    std::unique_ptr<StateFile> loaded_;
};

}  // namespace pbrt
