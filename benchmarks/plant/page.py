PAGE=""
