# Installs the npm packages of WEB_DIR that its lock file names, unless they are there already.
set(installed ${WEB_DIR}/node_modules/.package-lock.json)
if(EXISTS ${installed} AND NOT ${WEB_DIR}/package-lock.json IS_NEWER_THAN ${installed})
  return()
endif()
execute_process(COMMAND ${NPM} ci --loglevel=error WORKING_DIRECTORY ${WEB_DIR} RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "npm could not install the viewer's packages in ${WEB_DIR}: see its message above.")
endif()
