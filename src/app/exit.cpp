#include "app/exit.h"
