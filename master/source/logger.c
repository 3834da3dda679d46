/* The logger callback of FMI 2.0 is variadic. This shim formats the message and hands plain text to Rust. */
#include <stdarg.h>
#include <stdio.h>

extern void plimsoll_log_message(void *environment, const char *instance, int status, const char *category,
                                 const char *text);

void plimsoll_logger(void *environment, const char *instance, int status, const char *category, const char *message,
                     ...)
{
    char text[4096];
    va_list arguments;
    va_start(arguments, message);
    if (message == NULL || vsnprintf(text, sizeof text, message, arguments) < 0) {
        text[0] = '\0';
    }
    va_end(arguments);
    plimsoll_log_message(environment, instance, status, category, text);
}
