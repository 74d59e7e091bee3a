LABEL = "beside"
