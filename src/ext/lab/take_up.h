#pragma once
#include "ext/lab/lab_scene.h"
#include "ext/lab/run_record.h"

namespace pbrt::lab {

/// Loads the rounds of one run from disk, up to the last one from which the run can go on: every record up to it is
/// complete and belongs to this campaign, and so does the film of that round, or the finished picture if it is the last
/// of `checkpoints`. Removes later files, with a warning if a record is among them. `picture`: file of the finished
/// picture.
RunRecord TakeUpRun(const RecordFolder &records, const LabScene &scene, const std::string &sampler, int seed,
                    size_t checkpoints, const std::string &picture);

/// True if all pixels of R, G and B are finite.
bool IsFinite(const Image &picture);

/// True: the picture can be read, and has finite R, G and B at this resolution.
bool IsWholePicture(const std::string &file, Point2i resolution);

}  // namespace pbrt::lab
