#pragma once
#include <algorithm>

#include "pbrt/core/describe.h"

namespace ext {
using namespace pbrt;

inline constexpr Float kVisibilityFloor = 0.05f, kPaperFloor = 0.1f;  ///< defaults of OctreeParams::floor
/// Maximum candidates of VisibilityOctreeLightSampler; with more light groups, candidates are light tree nodes.
inline constexpr size_t kMaxCandidates = 64;
/// Version of the saved state of both samplers; incremented whenever the output of SaveLearned changes.
inline constexpr uint32_t kSavedVersion = 6;
inline constexpr std::string_view kOtherVersion = "another version of this light sampler wrote it";

struct OctreeParams {
    std::string model = "visibility";
    int leaves = 4096;
    int prepassspp = 0;
    int depth = 3;
    Float floor = 0;
    bool meshlights = true;
    Float budget = 0.01f;
    int tries = 0;
    int records = 50;
    Float shrinkage = 4;
    Float prunegain = 0.01f;
    bool secondmoment = true;
    bool bsdf = true;
    bool interior = true;
    int cut = 48;
    bool learn = true;
    std::string portals = "auto";

    /// Vertices of a prepass path, at most `maxDepth` of the integrator.
    int PrepassDepth(int maxDepth) const { return std::min(depth, std::max(1, maxDepth)); }

    void Describe(auto &&v) {
        v("model", model, Choices{"visibility", "paper"},
          "visibility: geometry at the point, visibility from the tree; paper: Noh, Choi, Moon 2023 as published");
        v("prepassspp", prepassspp, Range<int>{0, 1024},
          "camera paths per pixel in the prepass; 0: as many as budget allows (visibility) or 1 (paper)");
        v("depth", depth, Range<int>{1, 64}, "vertices of a prepass path");
        v("floor", floor, Range<Float>{0.f, 1.f},
          "part of the probability given by unoccluded importance alone; 0: 0.05 (paper: 0.1)");
        v.OnlyWith("model", "paper");
        v("leaves", leaves, Range<int>{64, 1 << 24},
          "paper: the paper's T: a cell is split while it holds more than 4N/T of the N prepass vertices");
        v.OnlyWith("model", "visibility");
        v("budget", budget, Range<Float>{1e-4f, 1.f},
          "visibility: rays of the prepass as a share of the render's rays; with more than 64 lights, 0.1 can "
          "reduce the error of renders of less than a second");
        v("tries", tries, Range<int>{0, 4096},
          "visibility: shadow rays from a prepass vertex; 0: one to each light if there are at most 64, "
          "else to 8 lights drawn by unoccluded importance");
        v("records", records, Range<int>{1, 1 << 20},
          "visibility: prepass vertices that a leaf should hold; a cell is split while it holds more than 4 times "
          "as many (with more than 64 lights: more than this number)");
        v("shrinkage", shrinkage, Range<Float>{0.f, 1e6f},
          "visibility: number of shadow rays that the parent cell's estimate counts for");
        v("prunegain", prunegain, Range<Float>{0.f, 1.f},
          "visibility: a split must lower the held-out second moment by this share; 0, and with more than 64 lights: "
          "keep all splits");
        v("secondmoment", secondmoment,
          "visibility: learn the root mean square of the contribution over the unoccluded one; false: the mean");
        v("bsdf", bsdf, "visibility: weigh lights by the BSDF on glossy surfaces");
        v("interior", interior, "visibility: choose a mesh's primitive by importance at the point; false: by power");
        v("cut", cut, Range<int>{2, 48},
          "visibility: nodes of the light tree in the cut of a leaf, with more than 64 lights");
        v("learn", learn, "visibility: with more than 64 lights, update the model from shadow rays of the render");
        v("portals", portals, Choices{"auto", "always", "never"},
          "visibility: find portals (windows, doors) and sample environment lights through them; auto: if a trial "
          "before the render shows less error at equal cost (path and volpath)");
        v.OnlyWith("", "");
        v("meshlights", meshlights,
          "an emissive mesh is one light for selection; visibility: unless at most eight primitives of the scene emit");
    }
};

}  // namespace ext
