/* The attitude on UART1, with a heartbeat a second. */
#ifndef TELEMETRY_H
#define TELEMETRY_H

#include "estimator.h"

/* Sends the attitude as of the newest gyro reading; time_boot_ms is its time. */
void telemetry_send(const struct estimator *e);

#endif
