#include "gl/context.h"
