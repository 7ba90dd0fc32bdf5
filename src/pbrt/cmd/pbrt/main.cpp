#include "pbrt/cmd/pbrt/render_job.h"

int main(int argc, char **argv) { return pbrt::RunPbrt(argc, argv); }
