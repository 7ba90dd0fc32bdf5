#pragma once
#include <functional>
#include <limits>
#include <span>
#include <string_view>

#include "pbrt/cameras/camera.h"
#include "pbrt/core/online_model.h"
#include "pbrt/core/team.h"
#include "pbrt/films/film.h"
#include "pbrt/films/filter.h"
#include "pbrt/lightsamplers/light_sampler.h"
#include "pbrt/samplers/sampler.h"

namespace pbrt {

class DirectionSampling;

/// A part of a render: some samples of every pixel of the film.
struct RenderPass {
    const Camera &camera;
    const Filter &filter;
    Film &film;
    std::span<const std::unique_ptr<Sampler>> samplers;  ///< one per thread, by ThreadIndex()
    int samplesPerPixel = 1;                             ///< in a batch of the samplers
    int batchFirst = 0;                                  ///< number of samples of a pixel before this batch
    int first = 0, count = 1;                            ///< which samples of the batch
    bool jittersPixels = true;  ///< false: sample pixel centres, lens centre, mid-shutter; full texture footprints
    bool jittersWavelengths = true;
    bool keepsSamples = true;  ///< false: the film holds these samples already; they are traced only to learn from them
    bool isCounted = true;     ///< every sample of a pixel counts in `progress`
    /// Null, or how much of the pass is done, for each of the parts in which the integrator renders it: what is done
    /// when Render is called (empty: nothing) is left out, and when it returns all is done, or what was done until it
    /// was cancelled.
    std::vector<uint32_t> *done = nullptr;
    std::string_view doneFile{};  ///< that `done` was read from, for messages
    Progress &progress;
    /// The processes that render the pass together, each with its own film: samples are distributed among them.
    /// Afterwards `done` of rank 0 holds what all have done.
    Team &team = Team::Alone();
};

/// A picture that an integrator makes beside the one of the film that it renders.
struct SidePicture {
    std::string name;  ///< to be appended to that of the film's file
    const Film *film = nullptr;
};

/// Adds samples to a film. Every sample is a function of pixel and sample index, and of what the OnlineModel learned
/// from fixed samples before it, so that any number of threads, and any split into passes, gives the same image.
class Integrator {
  public:
    virtual ~Integrator() = default;
    /// Before the first pass; the light sampler's prepass happens here.
    virtual void Prepare(PrepareContext &) {}
    /// False if cancelled: then some pixels lack samples of the pass; RenderPass::done lists which.
    virtual bool Render(const RenderPass &pass) = 0;
    /// The largest RenderPass::count that Render takes.
    virtual int MaxPassSamples() const { return std::numeric_limits<int>::max(); }
    /// The model that is updated between passes; null if there is none.
    virtual OnlineModel *Model() { return nullptr; }
    /// Writes the state of Prepare and of the model, for PrepareContext::learned of a resumed render. Not while rays
    /// are traced; the writer may refer to memory of this object.
    virtual void SaveLearned(StateWriter &writer) const {
        if (const LightSampler *lights = Lights()) lights->SaveLearned(writer, true);
    }
    /// Writes what other renders under the same lights can use, for PrepareContext::learned with `learnsOn` false.
    virtual void SaveForOthers(StateWriter &writer) const {
        if (const LightSampler *lights = Lights()) lights->SaveLearned(writer, false);
    }
    /// The light sampler in use; null if the integrator has none.
    virtual const LightSampler *Lights() const { return nullptr; }
    /// The light sampler that chooses where light paths begin; null if none do.
    virtual const LightSampler *EmissionSampler() const { return nullptr; }
    /// True if there will be side pictures. They hold only samples of this process since its start: checkpoints do not
    /// keep them, and other processes do not send theirs.
    virtual bool MakesSidePictures() const { return false; }
    /// After the first pass.
    virtual std::vector<SidePicture> SidePictures() const { return {}; }
    /// What chooses directions in place of BSDFs, or null.
    virtual const DirectionSampling *Directions() const { return nullptr; }
};

/// The chunks of a pass, which threads and processes render in any order.
struct PassChunks {
    int64_t count = 0;
    bool splat = false;  ///< samples add splats to the film, for one path each
    std::function<uint32_t(int64_t chunk)> samplesOf;
    /// Renders a chunk of which so many samples are done; returns how many are then: all, unless cancelled.
    std::function<uint32_t(int64_t chunk, uint32_t done)> render;
};

/// Renders what RenderPass::done does not name as done, and keeps account of it there. Returns whether the pass is
/// whole, in all processes that take part.
bool RenderChunks(const RenderPass &pass, const PassChunks &chunks);

}  // namespace pbrt
