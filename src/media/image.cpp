#include "media/image.h"
