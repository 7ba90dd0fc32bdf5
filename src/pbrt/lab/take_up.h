#pragma once
#include "pbrt/lab/lab_scene.h"
#include "pbrt/lab/run_record.h"

namespace pbrt::lab {

/// What the disk holds of one run, up to the last round that can be gone on from: every record until then is whole and
/// of this campaign, and so is the film of that round, or the finished picture if it is the last of `checkpoints`.
/// Removes what is beyond, and says so if that is more than an interruption leaves. `picture`: file of the finished
/// picture.
RunRecord TakeUpRun(const RecordFolder &records, const LabScene &scene, const std::string &sampler, int seed,
                    size_t checkpoints, const std::string &picture);

/// Can the picture be read, with R, G and B at this resolution?
bool IsWholePicture(const std::string &file, Point2i resolution);

}  // namespace pbrt::lab
