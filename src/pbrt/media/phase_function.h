#pragma once
// Media have one kind of phase function. It lives where coats of layered materials can use it, too.
#include "pbrt/bxdfs/henyey_greenstein.h"
