#include "pbrt/cmd/pbrt/render_job.h"
#include "pbrt/core/log.h"

int main(int argc, char **argv) { return pbrt::FinishOutput(pbrt::RunPbrt(argc, argv)); }
