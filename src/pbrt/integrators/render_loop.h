#pragma once
#include <functional>
#include <optional>
#include <string>

#include "pbrt/films/film.h"
#include "pbrt/integrators/integrator.h"

namespace pbrt {

struct RenderSettings {
    int samplesPerPixel = 16;
    /// > 0: render waves until this many seconds have passed since `start`, whatever samplesPerPixel says.
    double timeBudget = 0;
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
    bool disablePixelJitter = false;       ///< sample pixel centres, lens centre, mid-shutter; full texture footprints
    bool disableWavelengthJitter = false;
    std::string mseReferenceImage, mseReferenceOut;  ///< both or none
    /// Called after every wave if set: writes what there is (partial images).
    std::function<void(int samplesTaken)> afterWave;
};

struct RenderResult {
    int samplesTaken = 0;  ///< per pixel; on cancel some pixels have more
    double seconds = 0;    ///< rendering only
    bool cancelled = false;
    std::optional<double> mse;  ///< against the reference, of the last wave
};

/// Renders in waves of 1, 1, 2, 4, ... up to 64 samples per pixel over tiles. Every sample is a function of pixel and
/// sample index only, so any number of threads gives the same image. `makeSampler(round)` gives the sampler for the
/// round-th batch of samplesPerPixel samples (several rounds only under a time budget).
RenderResult RenderWaves(const Integrator &integrator, const Camera &camera, const Filter &filter, RgbFilm &film,
                         const std::function<std::unique_ptr<Sampler>(int round)> &makeSampler,
                         const RenderSettings &settings, Progress &progress);

}  // namespace pbrt
