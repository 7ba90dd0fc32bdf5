#pragma once
#include <functional>
#include <string>
#include <vector>

#include "pbrt/build/built_scene.h"
#include "pbrt/images/image.h"

namespace pbrt::lab {

/// How a look inside a light sampler is taken.
struct InspectSettings {
    int samples = 32;      ///< light samples (and shadow rays) per light and pixel
    int shownLights = 16;  ///< images of measured visibility, for the lights of most power
    /// Bound on pixels x (lights + groups x samples): beyond it only every n-th pixel of a row and column is looked at,
    /// and stands for its neighbours.
    double maxWork = 5e8;
};

/// One picture: a channel of Inspection::image.
struct InspectedLayer {
    std::string name, meaning;
    bool isId = false;                     ///< to be shown as colours without order
    bool ofScene = false;                  ///< the same for every sampler
    double shownLeast = 0, shownMost = 1;  ///< ends of the colour scale
    double least = 0, most = 0, mean = 0;  ///< finite values, over pixels that hit something ("hit": all)
    size_t values = 0, unknown = 0;        ///< how many these are, and how many are not finite
    std::string light;                     ///< name of the light it is about; empty: about none
    /// The same everywhere, or nowhere known: words say that better than a blank picture.
    bool IsFlat() const { return values == 0 || (least == most && unknown == 0); }
};

/// What counts as one light: a light, or all primitives of an emissive mesh.
struct InspectedLight {
    LightId first{};
    size_t count = 1;  ///< lights of the table, contiguous
    Float power = 0;
    std::string label;  ///< where it stands in the scene file: LightNames
};

struct Inspection {
    /// One float channel per layer, over the film's pixels. Layer "hit" is 1 where the camera sees a
    /// surface that is not purely specular, directly or through specular ones; all others are 0 elsewhere.
    Image image;
    std::vector<InspectedLayer> layers;  ///< "hit" first
    std::vector<InspectedLight> lights;
    std::string structure;  ///< LightSampler::DescribeStructure
    int stride = 1;         ///< see InspectSettings::maxWork
};

/// What `sampler` (prepared) does at what the camera sees first: one ray per pixel, through its centre, the
/// same for every call. Layers: every value of LightSampler::Inspect; entropy of the pmf over lights; the light that
/// contributes most, and its probability; second moment of the one-light estimator over the least possible one;
/// measured visibility of the strongest lights.
Inspection InspectLights(const BuiltScene &built, const LightSampler &sampler, const InspectSettings &settings,
                         Progress &progress);

/// One false-colour PNG per layer that is `wanted` and not flat into `folder`, which is made if need be; `legendRows`:
/// height of the bar of colours below. Returns what each shows: name, file (inside `folder`; null if flat), meaning,
/// ends of the colour scale, range.
nlohmann::ordered_json WriteLayers(const Inspection &inspection, const std::string &folder, int legendRows,
                                   const std::function<bool(const InspectedLayer &)> &wanted);

/// Writes inspect.exr (all layers), one false-colour PNG per layer that is not flat, inspect.json (what each shows and
/// its range), index.html (all of it to look at) and structure.txt into `folder`, which is made if need be.
void WriteInspection(const Inspection &inspection, const std::string &folder, const nlohmann::ordered_json &about);

/// The whole command: `lightlab inspect scene.pbrt --sampler octree`.
struct InspectOptions {
    std::vector<std::string> sceneFiles;
    BuildOptions build;  ///< build.lightSampler: the sampler to look into; film overrides set the resolution
    InspectSettings settings;
    std::string outFolder;  ///< empty: "inspect-<sampler>" in the working folder
    std::string commandLine;
};

/// Reads, builds, prepares, looks, writes, and prints the structure and the ranges to standard output. Exit status: 0,
/// or 130 if interrupted. Throws UserError.
int RunInspect(const InspectOptions &options, const LightSamplerRegistry &registry, Progress &progress);

}  // namespace pbrt::lab
