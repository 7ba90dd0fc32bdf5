#pragma once
#include <chrono>
#include <memory>

#include "pbrt/build/built_scene.h"
#include "pbrt/cmd/pbrt/command_line.h"
#include "pbrt/films/render_file.h"

namespace pbrt {

/// Checkpoint of one render: read with --resume before the scene is built, written during rendering.
class Checkpoint {
  public:
    /// Reads the file if the render is resumed and the file exists. Changes `build` so that the samples match the first
    /// run. `lightsHash`: of the --load-lights file, or empty. Throws UserError if the file is damaged, belongs to
    /// another render, or exists without --resume.
    static Checkpoint Open(const CommandLine &options, const SceneDescription &description,
                           const std::string &lightsHash, BuildOptions *build);

    bool IsResumed() const { return file_ != nullptr; }
    const std::string &Path() const { return path_; }
    const RenderFileHead &Head() const { return head_; }
    /// Requires IsResumed(); call before Begin.
    StateReader Learned() const { return file_->Learned(); }
    /// Loads the film and sets the resume position in `settings`; the integrator must be prepared. Throws UserError.
    void Begin(const BuiltScene &built, RenderSettings *settings);
    /// Writes the file. Failures are logged as warnings; Failure() is the message of the last call.
    void Write(const BuiltScene &built, const RenderPosition &position, const ImageMetadata &metadata);
    const std::string &Failure() const { return failure_; }
    double RenderSecondsBefore() const { return renderSecondsBefore_; }

  private:
    Checkpoint() = default;
    void Resume(const CommandLine &options, BuildOptions *build);

    std::string path_, failure_;
    RenderFileHead head_;
    std::unique_ptr<RenderFile> file_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), renderStart_;
    double secondsBefore_ = 0, renderSecondsBefore_ = 0;
    bool isTimed_ = false, isEndOpen_ = false;
};

}  // namespace pbrt
