#pragma once
#include <memory>

#include "pbrt/build/built_scene.h"
#include "pbrt/cmd/pbrt/command_line.h"
#include "pbrt/core/state_file.h"

namespace pbrt {

/// Files of --save-lights and --load-lights: light sampler records and a guide for other renders.
class LearnedLights {
  public:
    /// Reads the file to load. Throws UserError if it is damaged, or if the file to save is not writable.
    static LearnedLights Open(const CommandLine &options);

    bool AreUsed() const { return loaded_ || !savePath_.empty(); }
    bool AreLoaded() const { return loaded_ != nullptr; }
    /// Content hash of the loaded file; empty if none.
    std::string Hash() const;
    /// Checks that the sampler learns and that the loaded file matches the scene. Throws UserError.
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
