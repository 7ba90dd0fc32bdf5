#pragma once
#include <optional>

#include "pbrt/build/built_scene.h"
#include "pbrt/cmd/pbrt/command_line.h"
#include "pbrt/core/state_file.h"

namespace pbrt {

/// The files of --save-lights and --load-lights: what a light sampler and the guide have learned, for other
/// renders.
class LearnedLights {
  public:
    /// Reads the file to be loaded. Throws UserError if it is damaged, or if the other one cannot be written.
    explicit LearnedLights(const CommandLine &options);

    bool AreUsed() const { return loaded_ || !savePath_.empty(); }
    bool AreLoaded() const { return loaded_.has_value(); }
    /// Of the content of the loaded file; empty if there is none.
    std::string Hash() const;
    /// After the scene is built: that the sampler learns something, and that the loaded file fits. Throws UserError.
    void Check(const BuiltScene &built) const;
    StateReader Learned() const { return {loaded_->Section("learned"), loaded_->Path()}; }
    /// After the render. Throws UserError.
    void Save(const BuiltScene &built) const;
    const std::string &SavePath() const { return savePath_; }

  private:
    std::string savePath_;
    std::optional<StateFile> loaded_;
};

}  // namespace pbrt
